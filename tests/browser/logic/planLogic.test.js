import {
  adviceFacts, DEFAULT_MAP, DEFAULT_WISH, designLink, dotsOf, fromQuery, parseMap, parseWish, toQuery,
  valueInWords, withRow,
} from "/static/js/plan/planLogic.js";
import { specFromQuery } from "/static/js/design/specLogic.js";
import { contains, equal } from "./check.js";

const ADVICE = {
  window: 5, levels: 2, cell_mm: 15, ratio: 4, cells: 60, size_mm: 900, low_mm: 92.4, high_mm: 21000, notes: [],
};
const COVERAGE = {
  method: "dense", cell_px: 4.6, dead_bands: [],
  spans: [{ layer: "red", tilt_deg: 0, low_mm: 60, high_mm: 400 }],
};
const row = (height, share) => ({
  axis: "tilt_deg", heights_mm: [height], values: [0, 30], success: [[share, 0]], wrong: [[0, 0]], trials: 1,
});

export const tests = {
  "wanted heights as the server takes them": () => {
    equal(parseWish({ ...DEFAULT_WISH }), {
      wish: { low_mm: "100", high_mm: "8000", reach_mm: "200", tilt_deg: "20" }, errors: {},
    });
    contains(parseWish({ ...DEFAULT_WISH, high_mm: "90" }).errors.high_mm, "more than the lowest");
    contains(parseWish({ ...DEFAULT_WISH, low_mm: "" }).errors.low_mm, "Lowest: from 1");
    equal(parseWish({ ...DEFAULT_WISH, lean_deg: "80" }).wish, null);
  },
  "advice in words": () => {
    const facts = Object.fromEntries(adviceFacts(ADVICE));
    equal([facts["Red cells"], facts.Ratio], ["60 × 60, 15 mm", "4, blue cells of 60 mm"]);
    equal([facts.Pad, facts.Reads], ["900 × 900 mm", "92.4 mm … 21.00 m"]);
    contains(Object.fromEntries(adviceFacts({ ...ADVICE, ratio: 1 })).Ratio, "one layer");
  },
  "the advised pad fills the Design form": () => {
    const texts = specFromQuery(new URLSearchParams(designLink(ADVICE).split("?")[1]));
    equal([texts.rows, texts.cols, texts.cell_mm, texts.ratio], ["60", "60", "15", "4"]);
  },
  "a map looks a little beyond what reads": () => {
    const { plan } = parseMap({ ...DEFAULT_MAP, rows: "2", trials: "3" }, COVERAGE);
    equal([plan.axis, plan.heights_mm, plan.trials], ["tilt_deg", [500, 50], 3]);
    equal(parseMap({ ...DEFAULT_MAP, axis: "blur_px" }, COVERAGE).plan.values[1], 2);
    contains(parseMap({ ...DEFAULT_MAP, rows: "99" }, COVERAGE).errors.rows, "from 1 to 20");
    equal(parseMap({ ...DEFAULT_MAP }, null).plan, null);
  },
  "a map grows by rows, and its tilts are dots of the chart": () => {
    const map = withRow(withRow(null, row(500, 1)), row(50, 0.5));
    equal([map.heights_mm, map.success], [[500, 50], [[1, 0], [0.5, 0]]]);
    equal(dotsOf(map)[2], { tiltDeg: 0, heightMm: 50, share: 0.5 });
    equal([dotsOf(null), dotsOf({ ...map, axis: "blur_px" })], [[], []]);
    equal([valueInWords("tilt_deg", 30), valueInWords("blur_px", 4)], ["30°", "4 px"]);
  },
  "forms share the address under prefixes": () => {
    const texts = { ...DEFAULT_MAP, rows: "9" };
    equal(toQuery(texts, DEFAULT_MAP, "map-"), { "map-rows": "9" });
    equal(fromQuery(new URLSearchParams({ "map-rows": "9", rows: "4" }), DEFAULT_MAP, "map-"), texts);
  },
};
