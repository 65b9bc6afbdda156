import { changesChart } from "/static/js/flight/compareLogic.js";
import { heightsChart, outcomesChart, spaceChart, stagesChart, trajectoryChart } from "/static/js/flight/figuresLogic.js";
import { SERIES, seriesChart } from "/static/js/flight/charts/seriesChartLogic.js";
import { sweepChart } from "/static/js/flight/sweepLogic.js";
import { equal } from "./check.js";

const PALETTE = { x: "x", y: "y", height: "h", other: "o", ink: "i", ink2: "j", line: "l", ok: "k", stages: ["a", "b"] };
const FIGURES = {
  trajectory: {
    frame: [0, 5], time_s: [0, 0.5], x_mm: [100, 120], y_mm: [0, -10], z_mm: [2000, 1500], quality: ["full", "bearing"],
    heading_deg: [1, 2], tilt_deg: [3, 4], position_sigma_mm: [0.1, 0.2], attitude_sigma_deg: [0.01, 0.02],
    cells_read: [40, 50], cells_wrong: [0, 1], total_ms: [9, 8], edges_ms: [4, 3],
  },
  samples: [{ number: 1, frame: 0, position_mm: [100, 0, 2000], axis: [0, 0, -1], quality: "full" }],
};
const TIMELINE = {
  first_frame: 0, last_frame: 9, frames_per_column: 10,
  columns: [{ column: 0, first_frame: 0, outcomes: [5, 0, 0, 0, 0, 5], stages: { grid: 5 }, time_s: 0 }],
};

/** What follows each figure of a template, frames' numbers aside. */
const unitsOf = ({ hovertemplate }) =>
  [...hovertemplate.matchAll(/%\{[xyz][^}]*\}(\S* ?\S*)/g)].map(([, unit]) => unit.replace(/<.*/, "").trim());
const shown = (chart) => chart.data.filter(({ hoverinfo, type }) => hoverinfo !== "skip" && type !== "mesh3d");

export const tests = {
  "figures over time have their unit": () => {
    for (const name of Object.keys(SERIES)) {
      const traces = shown(seriesChart(FIGURES, null, name, PALETTE));
      equal(traces.length >= 2, true);
      for (const trace of traces) equal(unitsOf(trace).map((unit) => /^(mm|°|cells|ms)$/.test(unit)), [true]);
    }
  },
  "places have theirs, and the height is the camera's": () => {
    for (const trace of shown(trajectoryChart(FIGURES, null, PALETTE))) equal(unitsOf(trace).map((unit) => unit.split(" ")[0]), ["m"]);
    const [pose] = shown(spaceChart(FIGURES, null, PALETTE)).filter(({ name }) => name === "Pose");
    equal(pose.hovertext, ["frame 0<br>X 0.100 m, Y 0.000 m, height 2.000 m"]);
  },
  "shares and heights have theirs": () => {
    equal(unitsOf(outcomesChart(TIMELINE, null, PALETTE).data[0]), ["%"]);
    equal(unitsOf(stagesChart(TIMELINE, PALETTE).data[0]), ["frames,"]);
    const heights = { frame: [0], telemetry_m: [2], pose_mm: [2000], fit: null };
    equal(unitsOf(heightsChart(heights, PALETTE).data[0]).map((unit) => unit.split(/[ ,]/)[0]), ["m", "m"]);
  },
  "counts of frames are named as such": () => {
    const column = { first_frame: 3, last_frame: 3, won: 0, lost: 1 };
    equal(changesChart({ columns: [column] }, (name) => name).data[1].text, ["frame 3: 1 frame"]);
    const sweep = { parameter: "search.finest_px", values: [225], won: [6], lost: [0] };
    const chart = sweepChart(sweep, "px", (name) => name);
    equal([chart.data[0].text, chart.layout.xaxis.title], [["225 px: 6 frames"], "search.finest_px (px)"]);
  },
};
