import {
  heightsChart, heightsInWords, outcomesChart, samplesInWords, spaceChart, stagesChart, trajectoryChart,
  trajectoryInWords,
} from "/static/js/flight/figuresLogic.js";
import { contains, equal, near } from "./check.js";

const palette = { x: "x", y: "y", height: "h", other: "o", stages: ["a", "b"] };
const figures = {
  trajectory: {
    frame: [0, 5, 10], time_s: [0, 0.5, 1], x_mm: [100, null, 120], y_mm: [0, null, -10], z_mm: [2000, null, 1500],
  },
  samples: [
    { number: 1, frame: 0, position_mm: [100, 0, 2000], axis: [0, 0, -1] },
    { number: 2, frame: 5, position_mm: null, axis: null },
    { number: 3, frame: 10, position_mm: [120, -10, 1500], axis: [0, 0.6, -0.8] },
  ],
  heights: null,
};
const file = { levels: 2, layers: [{ channel: "red", cell_mm: 500, codes: ["01", "10"] }] };
const pad = { size: [1250, 1000], file };
const column = (at, outcomes, stages = {}) => ({ column: at, first_frame: 10 * at, last_frame: 10 * at + 9, time_s: at, outcomes, stages });
const timeline = {
  first_frame: 0, last_frame: 29, frames_per_column: 10,
  columns: [column(0, [10, 0, 0, 0, 0]), column(1, [3, 0, 2, 0, 5], { grid: 4, lines: 1 }), column(2, [0, 0, 0, 0, 10], { grid: 10 })],
};
const fit = (change) => ({
  slope: 1.05, slope_low: 1.04, slope_high: 1.06, offset_mm: 350, scatter_mm: 12, samples: 300, range_m: 9.5,
  verdict: "too_high", ...change,
});
const heights = (change) => ({ frame: [0, 1], telemetry_m: [1, 9], pose_mm: [1400, 9800], fit: fit(change) });

export const tests = {
  "the trajectory has height and both horizontal coordinates, broken where there is no pose": () => {
    const { data, layout } = trajectoryChart(figures, null, palette);
    equal(data.map((trace) => trace.name), ["Height", "X", "Y"]);
    equal(data[0].y, [2, null, 1.5]);
    equal([data[0].connectgaps, layout.xaxis.title], [false, "Time (s)"]);
    equal(trajectoryChart(figures, figures, palette).data.length, 6);
  },
  "where range and bearing alone are known, the range is shown and no place": () => {
    const trajectory = { ...figures.trajectory, quality: ["bearing", null, "full"] };
    const { data } = trajectoryChart({ ...figures, trajectory }, null, palette);
    equal(data[0].y, [null, null, 1.5]);
    equal([data[3].name, data[3].x, data[3].customdata], ["Range (bearing only)", [0], [0]]);
    near(data[3].y[0], Math.hypot(0.1, 0, 2), 1e-9);
    contains(trajectoryInWords({ trajectory }), "1 frame shows range and bearing only");
    equal(trajectoryInWords(figures), "");
    const samples = figures.samples.map((sample, at) => ({ ...sample, quality: trajectory.quality[at] }));
    const [way, cones, names] = spaceChart({ ...figures, trajectory, samples }, null, palette).data;
    equal([way.z, cones.z.length, names.text], [[null, null, 1.5], 1, ["3"]]);
    equal(samplesInWords(samples),
      "3 frames at equal distances; 2 is missing: no pose; 1 is missing: range and bearing only.");
  },
  "without times the trajectory stands over frames": () => {
    const stills = { ...figures, trajectory: { ...figures.trajectory, time_s: [null, null, null] } };
    const { data, layout } = trajectoryChart(stills, null, palette);
    equal([data[0].x, layout.xaxis.title], [[0, 5, 10], "Frame"]);
  },
  "cones open to where the camera looks; failed frames leave their number out": () => {
    const { data } = spaceChart(figures, pad, palette);
    const [, cones, names, here, margin, cells] = data;
    equal([here.name, margin.type, cells.facecolor.length], ["This frame", "mesh3d", 8]);
    equal([names.text, names.customdata], [["1", "3"], [0, 10]]);
    // A cone's vector leads from its base to its tip: up, where the camera looks down.
    equal(cones.w.map(Math.sign), [1, 1]);
    near(cones.v[1] / cones.w[1], -0.75, 1e-9);
    equal(cones.anchor, "tip");
    equal(spaceChart(figures, null, palette).data.length, 4);
  },
  "missing numbers are named": () => {
    contains(samplesInWords(figures.samples), "2 is missing");
    contains(samplesInWords(figures.samples.slice(0, 1)), "all with a pose");
  },
  "the share with a pose, column by column": () => {
    equal(outcomesChart(timeline, null, palette).data[0].y, [100, 50, 0]);
    equal(outcomesChart(timeline, timeline, palette).data.length, 2);
  },
  "failing stages are stacked, nothing is drawn where none failed": () => {
    const { data } = stagesChart(timeline, palette);
    equal(data.map((trace) => [trace.name, trace.y]), [["Grid", [0, 4, 10]], ["Lines", [0, 1, 0]]]);
    equal(stagesChart({ ...timeline, columns: [timeline.columns[0]] }, palette).data, []);
  },
  "heights come with the fitted line": () => {
    const { data } = heightsChart(heights(), palette);
    equal(data.map((trace) => trace.name), ["Frames", "Slope 1.050", "Slope 1"]);
    near(data[1].y[0], 1.05 + 0.35, 1e-9);
    equal(heightsChart({ ...heights(), fit: null }, palette).data.length, 1);
  },
  "too high a slope: the print is smaller, or the focal length too long": () => {
    const text = heightsInWords(heights());
    for (const part of ["Slope 1.050", "5 % too high", "print is smaller", "95 % of its size", "too long", "0.952"]) {
      contains(text, part);
    }
  },
  "too low a slope: the print is larger, or the focal length too short": () => {
    const text = heightsInWords(heights({ slope: 0.8, slope_low: 0.79, slope_high: 0.81, verdict: "too_low" }));
    for (const part of ["20 % too low", "larger", "125 %", "too short", "1.250"]) contains(text, part);
  },
  "agreement and doubt are said as such": () => {
    contains(heightsInWords(heights({ slope: 1, verdict: "agrees" })), "agree");
    contains(heightsInWords(heights({ verdict: "uncertain" })), "too little to judge");
    contains(heightsInWords({ ...heights(), fit: null }), "Too few");
    equal(heightsInWords(null), "");
  },
};
