import { cellsOf, lineOf, timelineChart } from "/static/js/flight/timelineChartLogic.js";
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
  "outcomes by their shares, from the foot up": () => {
    equal(cellsOf(column(0, [2, 0, 0, 1, 0])), [0, 0, 0, 0, 0, 0, 0, 3, 3, 3, 3]);
    equal(cellsOf(column(0, [0, 0, 8, 0, 0])), new Array(11).fill(2));
  },
  "poses of which range and bearing alone are known stand between the others and the failures": () => {
    equal(cellsOf(column(0, [4, 0, 0, 0, 3, 4])), [0, 0, 0, 0, 5, 5, 5, 5, 4, 4, 4]);
  },
  "a single failure among many is seen": () => {
    equal(cellsOf(column(0, [999, 0, 0, 0, 1])), [0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 4]);
    equal(cellsOf(column(0, [0, 0, 0, 0, 1])), new Array(11).fill(4));
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
    equal(strip.colorscale.slice(0, 3), [[0, "red"], [1 / 6, "red"], [1 / 6, "green"]]);
  },
  "strips of 22 pixels below, of both runs, and heights above": () => {
    const one = chart().layout;
    near(one.yaxis2.domain[1] * 144, 22);
    near(one.yaxis.domain[0] * 144, 28);
    const both = chart({ other: TIMELINE });
    near(both.layout.yaxis2.domain[0] * 144, 25);
    near(both.layout.yaxis3.domain[1] * 144, 22);
    equal(both.data.map((trace) => trace.type), ["heatmap", "heatmap", "scatter", "scatter"]);
    equal(both.data.slice(2).map((trace) => trace.line.color), ["ink-3", "ink"]);
  },
  "a part of the flight spans the width; heights from 0": () => {
    const { layout } = chart({ part: { first: 10, last: 29 } });
    equal([layout.xaxis.range, layout.yaxis.range], [[9.5, 29.5], [0, 1000]]);
    equal(chart().data[0].xgap, 1);
    equal(timelineChart({ timeline: TIMELINE, other: null, part: { first: 0, last: 4999 } }, String, 500, 144).data[0].xgap, 0);
  },
  "without a pose there are outcomes alone": () => {
    const none = { ...TIMELINE, columns: [column(0, [0, 0, 0, 0, 10])] };
    const { data, layout } = chart({ timeline: none });
    equal([data.length, layout.yaxis.visible], [1, false]);
  },
};
