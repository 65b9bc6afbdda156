import { capacityInWords, padFacts, sheetInWords, textsOfPad } from "/static/js/designLogic.js";
import { viewOfPad } from "/static/js/padLogic.js";
import { DEFAULT_SPEC } from "/static/js/specLogic.js";
import { equal } from "./check.js";

const FILE = {
  name: "tiny",
  window: 2,
  levels: 2,
  quiet_mm: 4,
  layers: [
    { channel: "red", cell_mm: 10, codes: ["0111", "1000", "1110", "0001"] },
    { channel: "blue", cell_mm: 20, codes: ["01", "11"] },
  ],
};
const SUMMARY = { name: "tiny", window: 2, levels: 2, seed: 9, method: "growth", unique: "plain", distance: 1 };

export const tests = {
  "a share of all codes": () => {
    equal(capacityInWords(DEFAULT_SPEC), "0.17 % of 8\u202f388\u202f608");
    equal(capacityInWords({ ...DEFAULT_SPEC, window: 8 }), "below 0.01 % of about 10¹⁹");
  },
  "the sheet": () => equal(sheetInWords({ ...DEFAULT_SPEC, rows: 60, cell_mm: 2.5 }), "312.5 × 150 mm"),
  "facts of a pad and of each layer": () => {
    const facts = Object.fromEntries(padFacts(viewOfPad(FILE)));
    equal([facts.Size, facts["Quiet margin"]], ["40 × 40 mm", "4 mm"]);
    equal([facts["Red cells"], facts["Blue cells"]], ["4 × 4, 10 mm", "2 × 2, 20 mm"]);
    equal([facts["Red at full level"], facts["Blue at full level"]], ["50.0 %", "75.0 %"]);
  },
  "a stored pad fills the form with what it was made from": () => {
    const texts = textsOfPad(SUMMARY, FILE);
    equal([texts.rows, texts.cols, texts.ratio, texts.cell_mm, texts.quiet_mm], ["4", "4", "2", "10", "4"]);
    equal([texts.seed, texts.unique, texts.method], ["9", "plain", "growth"]);
  },
  "a pad made elsewhere leaves the unknown at its default": () => {
    const texts = textsOfPad({ ...SUMMARY, seed: null, method: null, unique: null, distance: null },
      { ...FILE, layers: FILE.layers.slice(0, 1) });
    equal([texts.ratio, texts.seed, texts.unique, texts.method, texts.distance], ["1", "", "rotation", "auto", "1"]);
  },
};
