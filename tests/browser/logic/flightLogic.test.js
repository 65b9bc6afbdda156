import {
  differenceInWords, flightNotes, gapInWords, isRetryable, rangeInWords, reasonsOf, summaryFacts,
} from "/static/js/flight/flightLogic.js";
import { isOpen } from "/static/js/server/flightsApi.js";
import { progressInWords, restInWords } from "/static/js/shared/flightStateLogic.js";
import { hasPicture, shownOf, sourceInWords, withLook } from "/static/js/flight/flightFrameLogic.js";
import { bytes, clock, percent } from "/static/js/shared/formatLogic.js";
import { fusionOf, fusionValues, missingOrder, onlyValues, paramsInWords, rangeFault, rangeOf, rangeValues } from "/static/js/shared/orderLogic.js";
import { contains, equal } from "./check.js";

const flight = (change = {}) => ({
  id: "f", name: "landing", state: "running", created_at: "2026-05-04T09:30:00Z",
  started_at: "2026-05-04T09:30:00Z", finished_at: null, frames_total: 5400, frames_done: 1200,
  frames_ok: 1187, progress: 0.22, error: null, rerun_of: null,
  request: { pad_name: "A", camera_name: "C", method: "dense", params: {}, first_frame: 0, end_frame: null, stride: 1 },
  ...change,
});
const record = { source: "a.mp4", frame: 12, time_s: 0.4, status: "ok", elapsed_ms: {} };

export const tests = {
  "progress in words": () => {
    equal(progressInWords(flight()), "1200 of 5400 frames, 99 % with a pose");
    equal(progressInWords(flight({ state: "queued", frames_total: null })), "waits for its turn");
    equal(progressInWords(flight({ frames_total: null })), "looking into the files");
    equal(progressInWords(flight({ frames_total: 1, frames_done: 1, frames_ok: 0 })), "1 frame, 0 % with a pose");
  },
  "the rest follows from the rate so far": () => {
    const now = Date.parse("2026-05-04T09:30:20Z");
    equal(restInWords(flight(), now), "60 frames/s, about 1 min left");
    equal(restInWords(flight({ frames_done: 5000 }), now), "250 frames/s, about 2 s left");
    equal([restInWords(flight({ frames_done: 0 }), now), restInWords(flight({ state: "done" }), now)], ["", ""]);
  },
  "what can be done depends on the state": () => {
    const states = ["queued", "running", "done", "failed", "cancelled"].map((state) => flight({ state }));
    equal(states.map(isOpen), [true, true, false, false, false]);
    equal(states.map(isRetryable), [false, false, false, true, true]);
  },
  "ranges in words": () => {
    equal(rangeInWords({ first_frame: 0, end_frame: null, stride: 1 }), "all");
    equal(rangeInWords({ first_frame: 30, end_frame: 91, stride: 2 }), "30 to 90, every 2nd");
    equal(rangeInWords({ first_frame: 5, end_frame: null, stride: 11 }), "from 5, every 11th");
  },
  "range fields become what the server takes, and back": () => {
    equal(rangeValues({ first: "", last: "", stride: "" }), { first_frame: 0, end_frame: null, stride: 1 });
    const fields = { first: "10", last: "19", stride: "3" };
    equal(rangeValues(fields), { first_frame: 10, end_frame: 20, stride: 3 });
    equal(rangeOf(rangeValues(fields)), fields);
    equal(rangeOf({}), { first: "", last: "", stride: "" });
  },
  "wrong ranges are explained": () => {
    const fault = (change) => rangeFault({ first: "", last: "", stride: "", ...change });
    equal([fault({}), fault({ last: "0" })], ["", ""]);
    contains(fault({ first: "-1" }), "first frame");
    contains(fault({ first: "1.5" }), "whole");
    contains(fault({ stride: "0" }), "n must");
    contains(fault({ first: "9", last: "8" }), "before");
  },
  "how poses go together is kept for another run": () => {
    for (const fusion of ["none", "filter", "smooth"]) equal(fusionOf(fusionValues(fusion)), fusion);
    equal(fusionOf({}), "none");
  },
  "what is missing for an order": () => {
    equal(missingOrder({ pad: "1", camera: "2", files: 1 }), "");
    equal(missingOrder({ pad: "", camera: "", files: 0 }), "Choose a video or stills, a pad and a camera.");
  },
  "parameters in words": () => {
    equal(paramsInWords({ search: { least_step: 0.4, least_edges: 90 }, log10_false_alarm: -9 }),
      "search.least_step = 0.4, search.least_edges = 90, log10_false_alarm = -9");
    equal(paramsInWords({}), "");
  },
  "frames of another run": () => {
    equal(onlyValues("same", "no_edges"), {});
    equal(onlyValues("all", "no_edges"), { only: null });
    equal([onlyValues("failed", ""), onlyValues("failed", "no_edges")],
      [{ only: { status: "failed", reason: null } }, { only: { status: "failed", reason: "no_edges" } }]);
    equal(rangeInWords({ first_frame: 0, end_frame: null, stride: 1, only: { flight: "f", reason: "no_edges" } }),
      "all, of these only failed ones (no edges)");
    contains(shownOf(5, null, flight({ state: "done", request: { only: { flight: "f", reason: null } } })).message, "no other frames");
  },
  "figures of the summary": () => {
    const qualities = { full: 55, bearing: 3, unknown: 0 };
    const summary = { frames: 60, ok: 58, qualities, longest_gap: { first_frame: 3, frames: 2, seconds: 0.1 }, layers: { red: 29, outline: 29 } };
    equal(summaryFacts(summary), [
      ["With a pose", "58 of 60, 97 %"], ["Full poses", "55"], ["Range and bearing only", "3"],
      ["Without a pose", "2"], ["Longest gap", "2 frames, 0.1 s, from 3"],
      ["From the red layer", "50 %"], ["From the outline", "50 %"],
    ]);
    const unknown = summaryFacts({ ...summary, qualities: { ...qualities, unknown: 4 } });
    equal(unknown[3], ["Of unknown quality", "4"]);
    equal(summaryFacts({ ...summary, damaged: 3 }).at(-1), ["Damaged in the file", "3 frames"]);
    equal(gapInWords({ first_frame: 4, frames: 1, seconds: null }), "1 frame, from 4");
    equal(summaryFacts({ ...summary, frames: 0, ok: 0 }), [["Frames", "none read yet"]]);
  },
  "reasons come by number": () => {
    equal(reasonsOf({ reasons: { no_edges: 2, unknown_code: 9 } }).map((each) => each.text),
      ["unknown code (9)", "no edges (2)"]);
  },
  "damage and waits are told": () => {
    const sources = [{ name: "a.mp4", video: { damage: ["cut off"] } }];
    equal(flightNotes(flight({ sources })), ["a.mp4: cut off."]);
    equal(flightNotes(flight({ sources, notice: "no worker" })), ["Waiting: no worker.", "a.mp4: cut off."]);
  },
  "two runs differ in what they differ in": () => {
    const other = flight({ request: { ...flight().request, method: "paper" } });
    equal(differenceInWords(other, flight()), "Method: One window (paper) / All cells (dense)");
    equal(differenceInWords(flight(), flight()), "the same settings");
    equal(differenceInWords(flight({ id: "b" }), flight({ id: "a" })), "the same settings");
  },
  "a frame shows the flight's result until other settings are asked for": () => {
    const shown = shownOf(12, record, flight());
    equal([shown.status, shown.answer.trace, shown.name], ["ok", null, "Frame 12 · 0:00.40 · a.mp4"]);
    const look = { result: { status: "failed", stage: "grid", source: "x" }, stages: [{ name: "pose", channel: null, elapsed_ms: 1, failure: null }] };
    const same = withLook(shown, look, false);
    equal([same.status, same.answer.trace.stages.map((run) => run.name), same.answer.result], ["ok", ["pose"], record]);
    const other = withLook(shown, look, true);
    equal([other.status, other.answer.result.stage, other.answer.result.source, other.answer.result.frame], ["failed", "grid", "a.mp4", 12]);
    const lost = { ...record, frame: 14, status: "failed", stage: "read", reason: "frame_lost" };
    equal([hasPicture(record), hasPicture(lost), hasPicture({ ...lost, reason: "internal_error" })], [true, false, true]);
    equal(hasPicture({ ...lost, reason: "dropped_live" }), true);
    equal(shownOf(5, null, flight()).status, "waiting");
    equal(shownOf(5, null, flight({ state: "done" })).status, "refused");
    const nothing = shownOf(5, null, flight());
    equal(withLook(nothing, look, true), nothing);
  },
  "sizes, shares and times": () => {
    equal([0, 999, 1500, 1_116_415, 32e9].map(bytes), ["0 B", "999 B", "1.5 kB", "1.1 MB", "32.0 GB"]);
    equal([percent(1, 1), percent(0, 5), percent(1, 5000), percent(9999, 10_000), percent(1, 0)], ["100 %", "0 %", "< 0.1 %", "> 99.9 %", "–"]);
    equal([clock(0), clock(59.999), clock(3727.1, 1)], ["0:00.00", "1:00.00", "1:02:07.1"]);
    equal(sourceInWords(record), "Frame 12 · 0:00.40 · a.mp4");
  },
};
