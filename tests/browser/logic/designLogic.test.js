import { boundsInWords, padFacts, sheetInWords, tableSizes, textsOfPad } from "/static/js/design/designLogic.js";
import { viewOfPad } from "/static/js/design/padLogic.js";
import { DEFAULT_SPEC } from "/static/js/design/specLogic.js";
import { contains, equal } from "./check.js";

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
  "bounds say what is needed, what there is and how large a pad can be": () => {
    const bounds = {
      windows_needed: 14641, log10_possible: 25 * Math.log10(2), log10_at_most: Math.log10(322638), share: 0.05,
      largest_square: 571, outlook: "easy",
    };
    const words = boundsInWords(bounds, 4000);
    equal(words, {
      possible: "33\u202f554\u202f432", capacity: "14\u202f641 of 322\u202f638", largest: "571 × 571 cells", outlook: "",
    });
    contains(boundsInWords({ ...bounds, outlook: "long" }, 4000).outlook, "may take long");
    equal(boundsInWords({ ...bounds, log10_at_most: null }, 4000).capacity, "14\u202f641 of none");
    equal(boundsInWords({ ...bounds, log10_at_most: 60 }, 571).largest, "as large as may be");
    equal(boundsInWords(null, 4000).capacity, "–");
  },
  "a table takes what it does not say from the form's good fields": () => {
    const texts = { window: "4", cell_mm: " 7.5 ", ratio: "", quiet_mm: "x", rows: "9" };
    equal(tableSizes(texts), { layers: "independent", window: "4", cell_mm: "7.5" });
    equal(tableSizes({ ...texts, layers: "paper" }).layers, "paper");
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
  "how its layers were made is told by the file, else by its fields": () => {
    equal(textsOfPad(SUMMARY, FILE).layers, "independent");
    equal(textsOfPad(SUMMARY, { ...FILE, layer_fields: "paper", visible_lines: true }).visible_lines, "true");
    equal(textsOfPad(SUMMARY, { ...FILE, layer_fields: "paper" }).layers, "paper");
    const corner = [FILE.layers[0], { ...FILE.layers[1], codes: ["01", "10"] }];
    equal(textsOfPad(SUMMARY, { ...FILE, layers: corner }).layers, "paper");
    equal(textsOfPad(SUMMARY, { ...FILE, layers: corner.slice(0, 1) }).layers, "independent");
  },
  "a pad made elsewhere leaves the unknown at its default": () => {
    const texts = textsOfPad({ ...SUMMARY, seed: null, method: null, unique: null, distance: null },
      { ...FILE, layers: FILE.layers.slice(0, 1) });
    equal([texts.ratio, texts.seed, texts.unique, texts.method, texts.distance], ["1", "", "rotation", "auto", "1"]);
  },
};
