import {
  arrange, cornersFromText, cornersToText, firstFocus, keyOf, lineAt, lineInWords, partOf, placeFromText, placeOf, placeToText, viewFromText, viewportOf, viewToText,
} from "/static/js/shared/workbench/workbenchLogic.js";
import { cellAt, cellInWords, verdictOf, wrongCells } from "/static/js/shared/workbench/cellsLogic.js";
import { equal } from "./check.js";

const run = (name, channel, change = {}) => ({ name, channel, elapsed_ms: 1, failure: null, part: [0, 0, 8, 8], pixel: 1, ...change });
const STAGES = [run("clean", null, { part: null }), run("pose", null), run("edges", "blue"), run("lines", "red"), run("edges", "red"), run("stretch", null)];
const IMAGE = { width: 2000, height: 1000 };
const VIEW = { width: 400, height: 200 };
const LINES = [
  { points: [[0, 0], [100, 0]], family: 0, kind: "found", number: 4, text: "9 edge points lie on it" },
  { points: [[0, 10], [100, 10]], family: null, kind: "dropped", number: null, text: "its direction fits neither family" },
];
const LAYER = {
  channel: "red", cell_px: 10, read: 4, wrong: 1, row: [0, 0, 1, 1], column: [0, 1, 0, 1], x: [5, 15, 5, 15], y: [5, 5, 15, 15],
  expected: [0, 1, 1, 0], level: [0, 1, 0, 0], grey: [20, 200, 60, 30], thresholds: [[100], [100], [100], [100]], log10_false_alarm: -1,
  fits: [{ quarter_turns: 0, mirrored: false, share: 0.75 }, { quarter_turns: 0, mirrored: true, share: 0.5 }],
};

export const tests = {
  "rows are red above blue, columns follow the pipeline, what has no picture is left out": () => {
    const { columns, shared, rows } = arrange(STAGES);
    equal([columns, shared.map(({ name }) => name)], [["edges", "lines"], ["stretch", "pose"]]);
    equal(rows.map(({ channel, runs }) => [channel, runs.map(Boolean)]), [["red", [true, true]], ["blue", [true, false]]]);
  },
  "a failure is looked at first, else the pose": () => {
    equal(firstFocus({ result: { status: "ok" }, stages: STAGES }), { stage: "pose", channel: null });
    const failed = [...STAGES, run("grid", "red", { failure: { stage: "grid" } })];
    equal(firstFocus({ result: { status: "failed", stage: "grid" }, stages: failed }), { stage: "grid", channel: "red" });
    equal(firstFocus({ result: { status: "failed" }, stages: [] }), { stage: "frame", channel: null });
  },
  "views of any size look at the same place": () => {
    const place = { x: 500, y: 250, zoom: 4 };
    const [small, large] = [viewportOf(place, IMAGE, VIEW), viewportOf(place, IMAGE, { width: 800, height: 400 })];
    equal([small.x, small.y, large.scale / small.scale], [500, 250, 2]);
    equal(placeOf(small, IMAGE, VIEW), place);
    equal(placeOf(viewportOf(null, IMAGE, VIEW), IMAGE, VIEW), null);
    equal(placeOf({ x: 9e9, y: -5, scale: 9e9 }, IMAGE, VIEW).x, 2000);
  },
  "only the part that is shown is fetched": () => {
    equal(partOf(null, IMAGE, VIEW), null);
    equal(partOf({ x: 1000, y: 500, zoom: 10 }, IMAGE, VIEW), [870, 435, 1130, 565]);
    equal(partOf({ x: 0, y: 0, zoom: 2 }, IMAGE, VIEW), [0, 0, 650, 325]);
  },
  "place and view stand in the address": () => {
    equal(placeFromText(placeToText({ x: 1.5, y: 2, zoom: 3 })), { x: 1.5, y: 2, zoom: 3 });
    equal(cornersFromText(cornersToText([[1.5, 2], [30, 4.25]])), [[1.5, 2], [30, 4.25]]);
    equal([null, "", "1,2,3", "1,x", "1,2,3,4,5,6,7,8,9,10"].map(cornersFromText), [[], [], [], [], []]);
    equal(cornersToText([]), null);
    equal([placeToText(null), placeFromText("1,2"), placeFromText("1,2,0")], [null, null, null]);
    equal([viewToText({ stage: "block_mean", channel: "blue" }), viewFromText("blue-block_mean")], ["blue-block_mean", { channel: "blue", stage: "block_mean" }]);
    equal([viewFromText("pose"), viewFromText("<b>"), viewFromText(null)], [{ channel: null, stage: "pose" }, null, null]);
    equal(keyOf({ stage: "pose", channel: null }), "/pose");
  },
  "the line under the cursor says what it is, and why it was dropped": () => {
    equal(lineInWords(lineAt(LINES, { x: 50, y: 9 }, 5)), "dropped line: its direction fits neither family");
    equal(lineInWords(lineAt(LINES, { x: 50, y: 1 }, 5)), "line of the columns, number 4: 9 edge points lie on it");
    equal(lineAt(LINES, { x: 50, y: 40 }, 5), null);
  },
  "a cell tells what it should be and what is read": () => {
    equal([cellAt(LAYER, { x: 6, y: 14 }), cellAt(LAYER, { x: 60, y: 14 })], [2, null]);
    equal(cellInWords(LAYER, 2), "red cell, row 1, column 0: expected level 1, read 0; grey 60.0 of 255, threshold 100.0");
    equal(wrongCells(LAYER), [2]);
  },
  "the cells' verdict names a mirrored pad, a patch and chance": () => {
    const mirrored = { ...LAYER, fits: [LAYER.fits[0], { quarter_turns: 0, mirrored: true, share: 0.99 }] };
    equal(verdictOf({ ...mirrored, fits: [{ ...LAYER.fits[0], share: 0.5 }, mirrored.fits[1]] }).includes("seems mirrored"), true);
    equal(verdictOf({ ...LAYER, fits: [{ ...LAYER.fits[0], share: 0.99 }] }).endsWith("agree."), true);
    const grid = Array.from({ length: 100 }, (_, k) => k);
    const field = (/** @type {(row: number, column: number) => boolean} */ isWrong) => ({
      ...LAYER, read: 100, row: grid.map((k) => Math.floor(k / 10)), column: grid.map((k) => k % 10), x: grid, y: grid,
      expected: grid.map(() => 0), level: grid.map((k) => Number(isWrong(Math.floor(k / 10), k % 10))),
      wrong: grid.filter((k) => isWrong(Math.floor(k / 10), k % 10)).length,
      fits: [{ quarter_turns: 0, mirrored: false, share: 0.7 }],
    });
    equal(verdictOf(field((row) => row < 3)).includes("lie together"), true);
    equal(verdictOf(field((row, column) => (row + 2 * column) % 4 === 0)).includes("spread"), true);
    equal(verdictOf(field((row, column) => (row + column) % 2 === 0)).includes("another pad"), true);
    const small = verdictOf({ ...field((row, column) => (row + column) % 2 === 0), cell_px: 1.2 });
    equal([small.includes("another pad"), small.includes("1.2 px are too small")], [false, true]);
    const carried = verdictOf(field((row, column) => (row + column) % 2 === 0), true);
    equal([carried.includes("another pad"), carried.includes("the camera has moved")], [false, true]);
  },
};
