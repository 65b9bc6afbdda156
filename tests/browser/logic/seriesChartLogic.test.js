import { markIn } from "/static/js/flight/figuresLogic.js";
import { seriesChart, seriesColumns } from "/static/js/flight/charts/seriesChartLogic.js";
import { equal } from "./check.js";

const FIGURES = {
  trajectory: {
    frame: [0, 1, 2], time_s: [0, 0.1, 0.2], x_mm: [1, null, 3], y_mm: [0, null, 0], z_mm: [9, null, 8],
    quality: ["full", null, "bearing"], heading_deg: [5, null, 6], tilt_deg: [1, null, 2],
    position_sigma_mm: [null, null, null], attitude_sigma_deg: [0.1, null, 0.2], cells_read: [40, null, 50],
    cells_wrong: [0, null, 1], total_ms: [30, 60, 20], edges_ms: [2, 9, 1], decode_ms: [1, 1, 1],
  },
  samples: [], heights: null,
};
const PALETTE = { height: "h", x: "x", y: "y", stages: ["a", "b", "c"] };

export const tests = {
  "columns that hold nothing are left out": () => {
    equal(seriesColumns(FIGURES, "sigma").map(([name]) => name), ["attitude_sigma_deg"]);
    equal(seriesColumns(FIGURES, "cells").map(([name]) => name), ["cells_read", "cells_wrong"]);
  },
  "times begin with the total, then the longest stages": () => {
    equal(seriesColumns(FIGURES, "times").map(([name]) => name), ["total_ms", "edges_ms", "decode_ms"]);
  },
  "lines break where frames have no pose, and lead to frames": () => {
    const [heading, tilt] = seriesChart(FIGURES, null, "attitude", PALETTE).data;
    equal([heading.y, tilt.y], [[5, null, 6], [1, null, 2]]);
    equal([heading.x, heading.customdata, heading.connectgaps], [[0, 0.1, 0.2], [0, 1, 2], false]);
    equal(seriesChart(FIGURES, FIGURES, "attitude", PALETTE).data.length, 4);
  },
  "the mark stands at the frame, nowhere without a usable pose": () => {
    equal(markIn(FIGURES, 0).point, { x: [0.001], y: [0], z: [0.009] });
    equal(markIn(FIGURES, 1).point.x, [null]);
    equal(markIn(FIGURES, 2).point.x, [null]);
    equal(markIn(FIGURES, null).point.x, [null]);
  },
};
