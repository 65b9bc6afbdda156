import { coverageChart, outlineOf } from "/static/js/plan/coverageChartLogic.js";
import { equal, near } from "./check.js";

const span = (layer, tilt, low, high) => ({ layer, tilt_deg: tilt, low_mm: low, high_mm: high });
const FRAME = { lowMm: 10, highMm: 1000, mostDeg: 80 };
const COVERAGE = {
  method: "dense", cell_px: 4.6,
  spans: [span("red", 0, 20, 100), span("outline", 0, 60, 900), span("red", 80, 20, 50), span("outline", 80, null, null)],
  dead_bands: [{ tilt_deg: 80, low_mm: 50, high_mm: 500, message: "no layer reads" }],
};
const SHOWN = { coverage: COVERAGE, other: null, wish: null, frames: [], dots: [] };
const chart = (change = {}) => coverageChart({ ...SHOWN, ...change }, FRAME, (name) => `rgb(${name})`);
const named = ({ data }, name) => data.filter((trace) => trace.name === name);

export const tests = {
  "an area goes up one side and down the other, and stops where nothing reads": () => {
    equal(outlineOf(FRAME, [span("red", 0, 10, 1000), span("red", 80, 10, 100)]),
      { x: [0, 80, 80, 0, 0], y: [1000, 100, 10, 10, 1000] });
    const parted = [0, 20, 40].map((tilt) => span("red", tilt, tilt === 20 ? null : 10, 100));
    equal(outlineOf(FRAME, parted).x, [0, 0, 0, null, 40, 40, 40]);
    equal(outlineOf(FRAME, [span("red", 0, null, null)]), { x: [], y: [] });
    equal(outlineOf(FRAME, [span("red", 0, 1, 1e6)]).y, [1000, 10, 1000]);
  },
  "the whole sign lies under the layers, each in its colour": () => {
    const areas = named(chart(), "area");
    equal(areas.map((area) => area.line.color), ["rgb(ink-2)", "rgb(red)"]);
    equal(areas.map((area) => area.fillcolor), ["rgba(ink-2, 0.16)", "rgba(red, 0.28)"]);
    equal(areas.map((area) => area.fill), ["toself", "toself"]);
  },
  "the other method is outlined": () => {
    const outlines = named(chart({ other: COVERAGE }), "outline");
    equal(outlines.map(({ line, fill }) => [line.dash, fill]), [["dash", undefined], ["dash", undefined]]);
  },
  "a dead band and its name, turned inwards": () => {
    const { layout } = chart();
    equal(named(chart(), "dead band").length, 1);
    equal(layout.annotations.map((note) => [note.text, note.x, note.xanchor]), [["dead band", 80, "right"]]);
    near(10 ** layout.annotations[0].y, Math.sqrt(50 * 500));
    equal(chart({ coverage: { ...COVERAGE, dead_bands: [] } }).layout.annotations, []);
  },
  "axes of tilts and of heights in equal ratios": () => {
    const { xaxis, yaxis } = chart().layout;
    equal(xaxis.ticktext, ["0°", "15°", "30°", "45°", "60°", "75°"]);
    equal([yaxis.type, yaxis.range], ["log", [1, 3]]);
    equal([yaxis.tickvals[0], yaxis.ticktext[0], yaxis.ticktext.at(-1)], [10, "10 mm", "1000 mm"]);
  },
  "wanted heights, simulated pictures and places, kept on the chart": () => {
    const dots = [1, 0.5, 0].map((share) => ({ tiltDeg: 10, heightMm: 100, share }));
    const all = chart({ wish: { lowMm: 1, highMm: 200 }, dots, frames: [{ tiltDeg: 5, heightMm: 1e9 }] });
    equal(named(all, "wish").map((trace) => trace.y), [[10, 10], [200, 200]]);
    equal(named(all, "simulated")[0].marker.color, ["rgb(ok)", "rgb(warn)", "rgb(bad)"]);
    equal([named(all, "place")[0].x, named(all, "place")[0].y], [[5], [1000]]);
  },
};
