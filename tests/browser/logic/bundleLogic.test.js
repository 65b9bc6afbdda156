import {
  neighbourTitle, outcome, queryOf, rowsOf, shownNote, valueInWords, verdictOf, versionsInWords,
} from "/static/js/diagnose/bundleLogic.js";
import { equal } from "./check.js";

const ok = { status: "ok", position_mm: [0, 0, 512], layer: "blue" };
const failed = { status: "failed", stage: "lines", reason: "too_few_lines" };
const still = {
  reading: "still", params: {}, view: {}, same: true, versions: [], neighbours: [],
  differences: [], recorded_differences: [], alone_differences: [],
  result: ok, result_now: ok, recorded: null, recorded_now: null, recorded_version: "", alone: null, alone_now: null,
};
const off = [{ field: "cells_read", then: 812, now: 811 }];
const run = {
  ...still, reading: "run", same: false, recorded: ok, recorded_now: ok, recorded_version: "1.2",
  alone: failed, alone_now: ok, alone_differences: off, versions: [{ name: "numpy", then: "1", now: null }],
};

export const tests = {
  "a view opens under the bundle's own parameters": () => {
    const view = { view: "red-edges", set: "from.elsewhere:1" };
    equal(queryOf({ ...still, view, params: { log10_false_alarm: -9, search: { least_step: 0.5 }, refine: { at_rest: true } } }).get("set"),
      "log10_false_alarm:-9~search.least_step:0.5~refine.at_rest:true");
    equal(queryOf({ ...still, view }).toString(), "view=red-edges");
    equal(queryOf({ ...still, view: { cells: "neighbour" } }).toString(), "");
    equal(queryOf({ ...still, view: { cells: "own" } }).toString(), "cells=own");
  },
  "an outcome is a few words": () => {
    equal(outcome(ok), "pose, 512 mm up, blue");
    equal(outcome(failed), "Lines: too few lines");
    equal(outcome({ ...ok, quality: "bearing", range_mm: 512 }), "512 mm away, bearing only");
    equal(outcome(null), "no result");
  },
  "a still has one result, a run's frame has three, each then and now": () => {
    equal(rowsOf(still).map(({ name }) => name), ["The picture"]);
    equal(rowsOf(run).map(({ name }) => name), ["Recorded by the run (version 1.2)", "Read as the run does", "The frame by itself"]);
    equal(rowsOf(run)[2], { name: "The frame by itself", then: "Lines: too few lines", now: "pose, 512 mm up, blue", differences: off });
    equal(rowsOf({ ...run, recorded: null, alone: null }).length, 1);
  },
  "the verdict says whether versions may be why": () => {
    equal(verdictOf(still), "This install gives the very same result.");
    equal(verdictOf(run), "This install gives another result; its versions differ, too.");
    equal(verdictOf({ ...run, versions: [] }), "This install gives another result, with the same versions.");
    equal(versionsInWords(run), "Versions: numpy 1 in the bundle, none here.");
    equal(versionsInWords(still), "");
  },
  "which result is shown is said where there are several": () => {
    equal(shownNote(still), "");
    equal(shownNote(run).includes("by itself"), true);
  },
  "values of any kind are words, and not too many": () => {
    equal([null, undefined, "a", 1.5, { b: [1] }].map(valueInWords), ["nothing", "nothing", "a", "1.5", '{"b":[1]}']);
    equal(valueInWords("x".repeat(500)).length, 61);
  },
  "neighbours are named by their place": () => {
    equal(neighbourTitle({ offset: -1, result: ok, picture: null }), "The frame before: pose, 512 mm up, blue");
    equal(neighbourTitle({ offset: 1, result: null, picture: null }), "The frame after");
  },
};
