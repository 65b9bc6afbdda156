import { heightsOf, seenFrom, seenInWords, viewChart } from "/static/js/design/viewChartLogic.js";
import { viewOfPad } from "/static/js/design/padLogic.js";
import { contains, equal, near } from "./check.js";

const row = "01".repeat(25);
const pad = viewOfPad({
  name: "p", window: 5, levels: 2,
  layers: [
    { channel: "blue", cell_mm: 50, codes: Array(10).fill("01".repeat(5)) },
    { channel: "red", cell_mm: 10, codes: Array(50).fill(row) },
  ],
});
const view = { width_px: 2000, height_px: 1000, focal_px: 1500 };
const coverage = {
  method: "dense", cell_px: 4, sign_cell_px: 1,
  spans: [{ layer: "red", tilt_deg: 0, low_mm: 60, high_mm: 3000 }, { layer: "outline", tilt_deg: 0, low_mm: 5000, high_mm: 9000 }],
  dead_bands: [
    { tilt_deg: 0, low_mm: 3000, high_mm: 5000, message: "" },
    { tilt_deg: 30, low_mm: 2000, high_mm: 5000, message: "" },
  ],
};

export const tests = {
  "a cell is as many pixels as the focal length has it, the picture's shorter side holds so many": () => {
    const [red, blue] = seenFrom(pad, view, 300);
    equal([red.channel, red.pixels, red.cells, blue.channel, blue.pixels, blue.cells], ["red", 50, 20, "blue", 250, 4]);
  },
  "no more cells are in view than the layer has": () => {
    equal(seenFrom(pad, view, 100_000).map(({ cells }) => cells), [50, 10]);
  },
  "words name every layer": () => contains(seenInWords(pad, view, 300), "red 20 cells of 50 px, blue 4 cells of 250 px"),
  "heights go in even ratios from end to end": () => {
    const heights = heightsOf({ lowMm: 10, highMm: 1000 });
    near(heights[0], 10);
    near(heights.at(-1), 1000, 1e-6);
    near(heights[1] / heights[0], heights[31] / heights[30], 1e-9);
  },
  "dead bands seen from straight above are shaded": () => {
    const { data, layout } = viewChart(pad, view, coverage, (name) => name);
    equal(data.map(({ name }) => name).sort(), [
      "blue, cells in view", "blue, pixels a cell", "red, cells in view", "red, pixels a cell",
    ]);
    equal(layout.shapes.map(({ x0, x1 }) => [x0, x1]), [[3000, 5000]]);
  },
};
