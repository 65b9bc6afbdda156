import { noteOf, ofKind, progressInWords, reportInWords, sortedFiles, verdictKind } from "/static/js/experiments/experimentLogic.js";
import { equal } from "./check.js";

const experiment = (change = {}) => ({
  id: "a", kind: "reproduction", name: "tilts", state: "running", created_at: "2026-05-04T09:30:00Z", order: {},
  steps_done: 7, steps_total: 180, error: null, ...change,
});

export const tests = {
  "how far one is, is told in frames": () => {
    equal(progressInWords(experiment({ state: "queued" })), "Waiting for a free worker …");
    equal(progressInWords(experiment({ steps_total: 0 })), "Getting ready …");
    equal(progressInWords(experiment()), "7 of 180 frames");
  },
  "a list says what became of each": () => {
    equal(noteOf(experiment()), "7 of 180 frames");
    equal(noteOf(experiment({ state: "failed", error: { code: "x", message: "no room" } })), "failed: no room");
    equal(noteOf(experiment({ state: "cancelled" })), "stopped");
  },
  "where no report is, it says how to get one": () => {
    equal(reportInWords([experiment({ state: "done" }), experiment()]), "Open a run to read its report.");
    equal(reportInWords([experiment()]), "The report stands here when all frames are read.");
    equal(reportInWords([experiment({ state: "failed" })]).startsWith("No report yet."), true);
  },
  "each section has its own kind": () => {
    const all = [experiment(), experiment({ id: "b", kind: "shootout" })];
    equal(ofKind(all, "shootout").map(({ id }) => id), ["b"]);
  },
  "files that people look for stand first": () => {
    const files = ["a.svg", "b.csv", "report.html", "report.md", "a.csv"].map((name) => ({ name, media_type: "", size_bytes: 1 }));
    equal(sortedFiles(files).map(({ name }) => name), ["report.html", "report.md", "a.csv", "b.csv", "a.svg"]);
  },
  "verdicts have colours": () => {
    const kinds = ["held", "held within", "does not hold", "not measured"].map(verdictKind);
    equal(kinds, ["ok", "warn", "bad", "quiet"]);
  },
};
