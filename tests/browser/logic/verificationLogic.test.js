import { histogramBars, pairInWords, verificationFacts } from "/static/js/design/verificationLogic.js";
import { contains, equal, near } from "./check.js";

const CHECK = {
  channel: "red", window: 5, windows: 100, windows_possible: 2 ** 25, unique: true,
  unique_under_rotation: true, visible_lines: false, distance_limit: 2, min_distance: 4,
  min_distance_under_rotation: 3, histogram: [0, 0, 0, 100], histogram_under_rotation: [0, 0, 10, 90],
  level_counts: [60, 64], weakest: [],
};

export const tests = {
  "a check in words": () => {
    const facts = Object.fromEntries(verificationFacts(CHECK).facts);
    equal([facts["Each occurs once"], facts["Windows differ in"]], ["in all rotations", "≥ 3 cells"]);
    equal([facts["Misreads corrected"], facts["Of all windows"]], ["1", "below 0.001 %"]);
    equal([facts["Cells a level"], facts["Inner lines"]], ["48.4 : 51.6 %", "not all visible"]);
    contains(verificationFacts({ ...CHECK, unique: false }).fault, "twice in the red layer");
    equal(verificationFacts(null), { facts: [], fault: "", warning: "" });
  },
  "a check as printed counts windows as they stand": () => {
    const plain = verificationFacts({ ...CHECK, unique_under_rotation: false });
    equal(plain.facts.slice(1, 3), [["Each occurs once", "as printed"], ["Windows differ in", "≥ 4 cells"]]);
  },
  "the other layers are checked too": () => {
    const blue = { channel: "blue", unique: true, unique_under_rotation: false, min_distance: 2 };
    const { facts, fault } = verificationFacts({ ...CHECK, others: [blue] });
    equal([facts.at(-1), fault], [["The blue layer's", "as printed, ≥ 2 cells"], ""]);
    const twice = verificationFacts({ ...CHECK, others: [{ ...blue, unique: false }] });
    contains(twice.fault, "twice in the blue layer");
  },
  "layers beside each other": () => {
    const pair = { channels: ["red", "blue"], relation: "independent", shared: 0, is_corner: false, min_distance: 3 };
    const apart = verificationFacts({ ...CHECK, apart: [pair] });
    equal([apart.facts.at(-1), apart.warning], [["The layers", "independent, ≥\u00a03\u00a0cells"], ""]);
    const copy = verificationFacts({ ...CHECK, apart: [{ ...pair, relation: "shared", shared: 441, is_corner: true }] });
    contains(copy.facts.at(-1)[1], "441 windows in both: one copies");
    contains(copy.warning, "reads as another height");
    const close = verificationFacts({ ...CHECK, apart: [{ ...pair, relation: "near", min_distance: 1 }] });
    contains(close.facts.at(-1)[1], "nearer than");
    const three = ["green", "blue"].map((channel) => ({ ...pair, channels: ["red", channel] }));
    equal(verificationFacts({ ...CHECK, apart: three }).facts.at(-1)[0], "red and blue layers");
  },
  "broken promises are a fault": () => {
    contains(verificationFacts({ ...CHECK, broken: ["the layers are not independent"] }).fault, "not independent");
  },
  "bars of the distances that count": () => {
    equal(histogramBars(CHECK).map((bar) => bar.label), ["0", "1", "2", "≥ 3"]);
    near(histogramBars(CHECK)[2].share, 10 / 90);
    equal(histogramBars({ ...CHECK, unique_under_rotation: false })[3].count, 100);
    equal(histogramBars(null), []);
  },
  "two windows in words": () => {
    const pair = { row: 1, col: 2, other_row: 3, other_col: 4, turn: 1, distance: 1 };
    equal(pairInWords(pair), "1, 2 and 3, 4, turned by 90°: 1 cell");
    contains(pairInWords({ ...pair, other_row: 1, other_col: 2, turn: 2 }), "itself, turned by 180°");
  },
};
