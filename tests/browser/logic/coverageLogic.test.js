import {
  bandRuns, deadBandInWords, heightFacts, heightRange, heightSteps, layersOf, logTicks, moved, ofMethod, placeInWords,
  placeOf, surenessInWords, widestOf,
} from "/static/js/shared/coverageLogic.js";
import { contains, equal, near } from "./check.js";

const span = (layer, tilt, low, high) => ({ layer, tilt_deg: tilt, low_mm: low, high_mm: high });
const DENSE = {
  method: "dense", cell_px: 4.6,
  spans: [
    span("red", 0, 60, 400), span("blue", 0, 800, 4000),
    span("red", 30, 50, 300), span("blue", 30, null, null),
  ],
  dead_bands: [
    { tilt_deg: 0, low_mm: 400, high_mm: 800, message: "from 400 to 800 mm no layer reads" },
    { tilt_deg: 0, low_mm: 500, high_mm: 600, message: "narrow" },
  ],
};
const FRAME = { lowMm: 10, highMm: 1000, mostDeg: 80 };

export const tests = {
  "a chart's method and its layers": () => {
    const chart = { camera: "c", methods: [DENSE] };
    equal([ofMethod(chart, "dense"), ofMethod(chart, "paper"), ofMethod(null, "dense")], [DENSE, null, null]);
    equal(layersOf(DENSE), ["red", "blue"]);
  },
  "heights from step to step": () => {
    equal(heightRange([DENSE]), { lowMm: 50, highMm: 5000 });
    equal(heightRange([{ ...DENSE, spans: [] }]), { lowMm: 10, highMm: 10000 });
    equal(logTicks(0.05, 3), [0.05, 0.1, 0.2, 0.5, 1, 2]);
  },
  "places of the chart": () => {
    const { tiltDeg, heightMm } = placeOf(FRAME, 0.5, 0.5);
    near(tiltDeg, 40);
    near(heightMm, 100, 1e-6);
    near(placeOf(FRAME, 0, 0).heightMm, 10);
    near(placeOf(FRAME, -0.5, 3).heightMm, 1000);
    near(placeOf(FRAME, -0.5, 3).tiltDeg, 0);
  },
  "arrow keys move within the chart": () => {
    const place = { tiltDeg: 10, heightMm: 500 };
    near(moved(place, "ArrowUp", FRAME).heightMm, 550);
    equal(moved(place, "ArrowLeft", FRAME), { tiltDeg: 7.5, heightMm: 500 });
    near(moved({ tiltDeg: 79, heightMm: 990 }, "ArrowUp", FRAME).heightMm, 1000);
    equal(moved({ tiltDeg: 79, heightMm: 990 }, "ArrowRight", FRAME).tiltDeg, 80);
    equal(moved(place, "x", FRAME), null);
  },
  "dead bands join those of the next tilt that they overlap with": () => {
    const band = (tilt, low, high) => ({ tilt_deg: tilt, low_mm: low, high_mm: high, message: "" });
    const tilts = [0, 10, 20, 30].map((tilt) => span("red", tilt, 10, 100));
    const dead = [band(0, 100, 200), band(10, 110, 220), band(10, 500, 600), band(30, 110, 220)];
    const runs = bandRuns({ ...DENSE, spans: tilts, dead_bands: dead });
    equal(runs, [[dead[0], dead[1]], [dead[2]], [dead[3]]]);
    equal(widestOf(dead), dead[0]);
  },
  "a dead band in words, with the tilt where it begins": () => {
    equal(deadBandInWords(DENSE), "From 400 to 800 mm no layer reads.");
    const leaning = { ...DENSE, dead_bands: [{ ...DENSE.dead_bands[0], tilt_deg: 30 }] };
    contains(deadBandInWords(leaning), "At 30° of tilt and more, from 400");
    equal([deadBandInWords({ ...DENSE, dead_bands: [] }), deadBandInWords(null)], ["", ""]);
  },
  "heights from straight above, in words": () => {
    equal(heightFacts(DENSE), [["Red layer", "60.0 mm … 400 mm"], ["Blue layer", "800 mm … 4.00 m"]]);
  },
  "how well the ends hold": () => {
    contains(surenessInWords("dense"), "10 % of height");
    contains(surenessInWords("paper"), "fades");
  },
  "what reads at a place": () => {
    equal(placeInWords(DENSE, { tiltDeg: 3, heightMm: 200 }), "200 mm, tilt 3°: red reads");
    contains(placeInWords(DENSE, { tiltDeg: 0, heightMm: 500 }), "nothing reads");
    const signed = { ...DENSE, spans: [...DENSE.spans, span("outline", 0, 100, 6000)] };
    contains(placeInWords(signed, { tiltDeg: 0, heightMm: 200 }), "red and the whole sign read");
    contains(placeInWords(signed, { tiltDeg: 0, heightMm: 5000 }), "the whole sign reads");
    equal(heightFacts(signed).at(-1), ["Whole sign", "100 mm … 6.00 m"]);
    contains(placeInWords(DENSE, { tiltDeg: 29, heightMm: 900 }), "nothing reads");
  },
  "even ratios of height": () => {
    equal(heightSteps(100, 1600, 5), [1600, 800, 400, 200, 100]);
    equal(heightSteps(100, 1600, 1), [1600]);
  },
};
