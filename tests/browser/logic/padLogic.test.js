import {
  cellAt, layerPixels, layersOfView, levelShares, padFrame, resizedFile, resizedView, viewOfPad, windowCode, windowRound,
} from "/static/js/design/padLogic.js";
import { placeInWords } from "/static/js/design/placeLogic.js";
import { contains, equal } from "./check.js";

const FILE = {
  name: "tiny",
  window: 2,
  levels: 3,
  quiet_mm: 5,
  layers: [
    { channel: "blue", cell_mm: 20, codes: ["01", "20"] },
    { channel: "red", cell_mm: 10, codes: ["0120", "1202", "2011", "0221"] },
  ],
};
const pad = viewOfPad(FILE);
const red = pad.layers[1];

export const tests = {
  "a file becomes layers with sizes": () => {
    equal([pad.widthMm, pad.heightMm, pad.quietMm], [40, 40, 5]);
    equal([red.rows, red.cols, red.levels.length], [4, 4, 16]);
  },
  "levels above nine are letters": () => {
    const view = viewOfPad({ ...FILE, levels: 36, layers: [{ channel: "red", cell_mm: 1, codes: ["az"] }] });
    equal([...view.layers[0].levels], [10, 35]);
  },
  "a new size is what its file would be read as, whatever the ratio": () => {
    for (const ratio of [1, 2, 2.5, 3]) {
      const layers = [{ ...FILE.layers[0], cell_mm: 0.7 * ratio }, { ...FILE.layers[1], cell_mm: 0.7 }];
      const old = { ...FILE, scale: [1.01, 1], crosstalk: [[1]], seed: 7, layers };
      const file = resizedFile(old, { name: "new", cell_mm: 0.1, quiet_mm: 3 });
      equal(file.layers[0].cell_mm, ratio * 0.1);
      equal([file.name, file.seed, "scale" in file, "crosstalk" in file], ["new", 7, false, false]);
      equal(resizedView(viewOfPad(old), file), viewOfPad(file));
    }
  },
  "a layer lights its own channel, evenly spaced": () => {
    const pixels = layerPixels(red, 3);
    equal([...pixels.slice(0, 12)], [0, 0, 0, 255, 128, 0, 0, 255, 255, 0, 0, 255]);
    equal([...layerPixels(pad.layers[0], 3).slice(8, 12)], [0, 0, 255, 255]);
  },
  "the print shows all layers, the finest first": () => {
    equal(layersOfView(pad, "print").map((layer) => layer.channel), ["red", "blue"]);
    equal(layersOfView(pad, "blue").map((layer) => layer.channel), ["blue"]);
    equal(layersOfView(pad, "green"), []);
  },
  "a place on the page is a cell, or none in the margin": () => {
    const { row, col, level } = cellAt(red, 5 + 21, 5 + 9.9, pad);
    equal([row, col, level], [0, 2, 2]);
    equal(cellAt(red, 4.9, 10, pad), null);
    equal(cellAt(red, 45, 10, pad), null);
  },
  "a window stays inside the layer": () => {
    const at = (row, col) => windowRound({ layer: red, row, col, level: 0 }, 2);
    equal([at(0, 0), at(3, 3), at(1, 2)], [{ row: 0, col: 0 }, { row: 2, col: 2 }, { row: 1, col: 2 }]);
    equal(windowRound({ layer: red, row: 0, col: 3, level: 0 }, 3), { row: 0, col: 1 });
  },
  "a code is the base-Y number of the cells, row by row": () => {
    equal(windowCode(red, 0, 1, 2, 3), BigInt(1 * 27 + 2 * 9 + 2 * 3 + 0));
    const vast = viewOfPad({ ...FILE, levels: 36, layers: [{ channel: "red", cell_mm: 1, codes: Array(9).fill("z".repeat(9)) }] });
    equal(windowCode(vast.layers[0], 0, 0, 9, 36), 36n ** 81n - 1n);
  },
  "the pad frame has its origin in the middle and Y up": () => {
    equal(padFrame(pad, 5, 5), { x: -20, y: 20 });
    equal(padFrame(pad, 25, 45), { x: 0, y: -20 });
  },
  "shares of levels add up": () => {
    const shares = levelShares(red, 3);
    equal(shares, [5 / 16, 5 / 16, 6 / 16]);
  },
  "a place in words names every layer's cell, the window's code and millimetres": () => {
    const place = { x: 26, y: 14 };
    const cell = cellAt(red, place.x, place.y, pad);
    const text = placeInWords(pad, "print", place, cell, { row: 0, col: 1 });
    contains(text, "red row 0, column 2: level 2");
    contains(text, "blue row 0, column 1: level 1");
    contains(text, "code 51");
    contains(text, "X 1.0, Y 11.0 mm");
  },
};
