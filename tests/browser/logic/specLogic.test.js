import {
  bigNumber, capacity, DEFAULT_SPEC, parseSpec, sheetSize, specFromQuery, specToQuery, specToTexts,
} from "/static/js/design/specLogic.js";
import { contains, equal, near } from "./check.js";

const whole = (least, most, label) => ({ least, most, whole: true, label });
const BOUNDS = {
  window: whole(2, 16, "Window"),
  levels: whole(2, 36, "Levels"),
  rows: whole(2, 2000, "Rows"),
  cols: whole(2, 2000, "Columns"),
  ratio: whole(1, 2000, "Ratio"),
  distance: whole(1, 256, "Distance"),
  seed: whole(0, Number.MAX_SAFE_INTEGER, "Seed"),
  cell_mm: { least: 0.01, most: 10000, whole: false, label: "Cell" },
  quiet_mm: { least: 0, most: 10000, whole: false, label: "Margin" },
};
const parse = (change) => parseSpec({ ...specToTexts(DEFAULT_SPEC), ...change }, BOUNDS);

export const tests = {
  "the defaults come through unchanged": () => {
    equal(parse({}), { spec: { ...DEFAULT_SPEC }, errors: {} });
  },
  "an empty seed leaves the choice to the server": () => equal(parse({ seed: "" }).spec.seed, null),
  "texts become numbers and choices": () => {
    const { spec } = parse({ cell_mm: "2.5", visible_lines: "true", unique: "plain", name: " x " });
    equal([spec.cell_mm, spec.visible_lines, spec.unique, spec.name], [2.5, true, "plain", "x"]);
    equal([spec.layers, parse({ layers: "paper" }).spec.layers], ["independent", "paper"]);
  },
  "each fault names its bounds and there is no spec": () => {
    const faults = {
      window: ["40", "from 2 to 16"],
      rows: ["1e9", "from 2 to 2000"],
      cols: ["7.5", "whole number"],
      cell_mm: ["0", "from 0.01 to 10\u202f000"],
      quiet_mm: ["", "enter a number"],
      levels: ["NaN", "enter a number"],
    };
    for (const [key, [text, says]] of Object.entries(faults)) {
      const { spec, errors } = parse({ [key]: text });
      equal([spec, Object.keys(errors)], [null, [key]]);
      contains(errors[key], says);
    }
  },
  "a window must fit into both layers": () => {
    contains(parse({ rows: "4" }).errors.rows, "At least 5 rows");
    equal(parse({ ratio: "25" }).errors, {});
    contains(parse({ ratio: "26" }).errors.ratio, "At most 25");
    contains(parse({ distance: "26" }).errors.distance, "25 cells");
  },
  "more windows than codes cannot be": () => {
    contains(parse({ window: "3" }).errors.window, "only 128 codes");
    equal(parse({ window: "3", rows: "12", cols: "12", ratio: "4" }).errors, {});
    const both = { window: "3", rows: "13", cols: "13", ratio: "2" };
    contains(parse(both).errors.window, "137 windows");
    equal(parse({ ...both, layers: "paper" }).errors, {});
    contains(parse({ window: "3", rows: "14", cols: "14", ratio: "4" }).errors.window, "145 windows");
  },
  "capacity counts windows and codes": () => {
    const { windows, log10Codes, share } = capacity(DEFAULT_SPEC);
    equal(windows, 121 * 121 + 21 * 21);
    equal(capacity({ ...DEFAULT_SPEC, layers: "paper" }).windows, 121 * 121);
    equal(capacity({ ...DEFAULT_SPEC, ratio: 1 }).windows, 121 * 121);
    near(10 ** log10Codes, 2 ** 23, 1);
    near(share, 15082 / 2 ** 23, 1e-9);
    near(10 ** capacity({ ...DEFAULT_SPEC, unique: "plain" }).log10Codes, 2 ** 25, 1);
  },
  "large counts are powers of ten": () => {
    equal([bigNumber(Math.log10(128)), bigNumber(30.2)], ["128", "about 10³⁰"]);
  },
  "the sheet includes the margin": () => {
    equal(sheetSize({ ...DEFAULT_SPEC, quiet_mm: 20 }), { width: 1290, height: 1290 });
  },
  "the address holds what differs, and brings it back": () => {
    const texts = { ...specToTexts(DEFAULT_SPEC), rows: "60", name: "a & b", seed: "" };
    const query = specToQuery(texts);
    equal(Object.keys(query).sort(), ["name", "rows", "seed"]);
    equal(specFromQuery(new URLSearchParams(query)), texts);
  },
};
