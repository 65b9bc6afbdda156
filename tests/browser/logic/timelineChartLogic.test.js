import { cellsOf, kindsOf, kindsShown, lineOf, timelineChart } from "/static/js/flight/timelineChartLogic.js";
import { equal, near } from "./check.js";

// OUTCOMES: red, green, blue, outline, failed, bearing; older answers lack the last.
const column = (at, outcomes, low = null, high = low) => ({
  column: at, first_frame: 10 * at, last_frame: 10 * at + 9, time_s: at, z_min_mm: low, z_max_mm: high, outcomes, stages: {},
});
const TIMELINE = {
  first_frame: 0, last_frame: 49, frames_per_column: 10,
  columns: [column(0, [10, 0, 0, 0, 0], 900, 1000), column(1, [10, 0, 0, 0, 0], 800, 900),
    column(2, [0, 0, 0, 0, 10]), column(4, [0, 0, 5, 5, 0], 500)],
};
const PART = { first: 0, last: 49 };
const chart = (change = {}) =>
  timelineChart({ timeline: TIMELINE, other: null, part: PART, ...change }, (name) => name, 500, 144);

export const tests = {
  "a channel's frames by their shares, from the foot up": () => {
    equal(cellsOf(column(0, [2, 0, 0, 1, 0]), "red"), [0, 0, 0, 0, 0, 0, 0, 2, 2, 2, 2]);
    equal(cellsOf(column(0, [2, 0, 0, 1, 0]), "blue"), [2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3]);
    equal(cellsOf(column(0, [0, 0, 8, 0, 0]), "blue"), new Array(11).fill(0));
  },
  "failures stand on top, by the stage of each channel": () => {
    const failed = { ...column(0, [5, 0, 0, 0, 6]), stages: { decode: 6 }, failed_at: { red: { lines: 6 }, blue: { decode: 4 } } };
    equal(cellsOf(failed, "red"), [0, 0, 0, 0, 0, 8, 8, 8, 8, 8, 8]);
    equal(kindsOf(failed, "blue"), { own: 0, bearing: 0, outline: 0, other: 5, decode: 4, unseen: 2 });
    const old = { ...failed, failed_at: undefined };
    equal([kindsOf(old, "red").decode, kindsOf(old, "blue").decode], [6, 6]);
  },
  "a single failure among many is seen": () => {
    const one = { ...column(0, [999, 0, 0, 0, 1]), stages: { grid: 1 } };
    equal(cellsOf(one, "red"), [0, 0, 0, 0, 0, 0, 0, 0, 9, 9, 9]);
    equal(kindsShown([{ ...TIMELINE, columns: [one] }]), ["own", "other", "grid"]);
  },
  "the line breaks where no frame has a pose; a column alone is a dot": () => {
    const { x, y } = lineOf(TIMELINE, 0.1, {});
    equal(x, [null, 4.4, 4.5, 4.5, 14.5, 14.5, null, 44.4, 44.5, 44.5]);
    equal(y, [null, 1000, 1000, 900, 900, 800, null, 500, 500, 500]);
  },
  "columns that were not read stay empty": () => {
    const [strip] = chart().data;
    equal([strip.type, strip.z.length, strip.z[0].length], ["heatmap", 11, 5]);
    equal(strip.z.map((row) => row[3]), new Array(11).fill(null));
    equal([strip.x0, strip.dx], [4.5, 10]);
    equal(strip.colorscale.slice(0, 3), [[0, "red"], [1 / 12, "red"], [1 / 12, "bearing"]]);
  },
  "a strip of 16 pixels for each channel below, of both runs, and heights above": () => {
    const one = chart().layout;
    near(one.yaxis2.domain[0] * 144, 19);
    near(one.yaxis3.domain[1] * 144, 16);
    near(one.yaxis.domain[0] * 144, 41);
    const both = chart({ other: TIMELINE });
    near(both.layout.yaxis5.domain[1] * 144, 16);
    equal(both.data.map((trace) => trace.type), [...new Array(4).fill("heatmap"), "scatter", "scatter"]);
    equal(both.data.slice(4).map((trace) => trace.line.color), ["ink-3", "ink"]);
  },
  "a part of the flight spans the width; heights from 0": () => {
    const { layout } = chart({ part: { first: 10, last: 29 } });
    equal([layout.xaxis.range, layout.yaxis.range], [[9.5, 29.5], [0, 1000]]);
    equal(chart().data[0].xgap, 1);
    const [dense] = timelineChart({ timeline: TIMELINE, other: null, part: { first: 0, last: 4999 } }, String, 500, 144).data;
    equal(dense.xgap, 0);
    // Plotly needs no style of its own for it.
    equal(dense.ygap > 0, true);
  },
  "without a pose there are outcomes alone": () => {
    const none = { ...TIMELINE, columns: [column(0, [0, 0, 0, 0, 10])] };
    const { data, layout } = chart({ timeline: none });
    equal([data.length, layout.yaxis.visible], [2, false]);
  },
};
