import { padMeshes } from "/static/js/flight/padSurfaceLogic.js";
import { equal, near } from "./check.js";

const FILE = {
  name: "a", window: 2, levels: 2,
  layers: [{ channel: "red", cell_mm: 10, codes: ["0101", "1100"] }, { channel: "blue", cell_mm: 20, codes: ["01"] }],
};

export const tests = {
  "every cell has its colours, row by row from the page's top left": () => {
    const [margin, cells] = padMeshes({ size: [60, 40], file: FILE });
    const colours = cells.facecolor.filter((_, at) => at % 2 === 0);
    const [dark, red, blue, both] = ["rgb(30,30,30)", "rgb(255,30,30)", "rgb(30,30,255)", "rgb(255,30,255)"];
    equal(colours, [dark, red, blue, both, red, red, blue, blue]);
    near(cells.x[0], -0.02);
    near(cells.y[0], 0.01);
    near(Math.max(...margin.x), 0.03);
    equal([cells.i.length, cells.facecolor.length], [16, 16]);
  },
  "a pad of very many cells is drawn coarser": () => {
    const row = "01".repeat(500);
    const file = { ...FILE, layers: [{ channel: "red", cell_mm: 1, codes: new Array(1000).fill(row) }] };
    const [, cells] = padMeshes({ size: [1000, 1000], file });
    equal(cells.facecolor.length, 2 * 160 * 160);
  },
  "levels are shades": () => {
    const file = { ...FILE, levels: 3, layers: [{ channel: "red", cell_mm: 10, codes: ["012"] }] };
    const [, cells] = padMeshes({ size: [30, 10], file });
    equal(cells.facecolor.filter((_, at) => at % 2 === 0), ["rgb(30,30,30)", "rgb(143,30,30)", "rgb(255,30,30)"]);
  },
  "the margin lies below, as large as the pad": () => {
    const [margin, cells] = padMeshes({ size: [60, 40], file: FILE });
    equal([margin.z[0] < cells.z[0], margin.y[0], margin.facecolor.length], [true, 0.02, 2]);
  },
};
