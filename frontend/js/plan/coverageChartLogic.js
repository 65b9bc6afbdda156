/**
 * Heights against tilts as a chart: where each layer reads, dead bands, wanted heights, pictures.
 *
 * @typedef {import("../shared/components/plot.js").Chart} Chart
 * @typedef {import("../shared/components/plot.js").Colours} Colours
 * @typedef {import("../shared/coverageLogic.js").Frame} Frame
 * @typedef {import("../shared/coverageLogic.js").MethodCoverage} MethodCoverage
 * @typedef {{tiltDeg: number, heightMm: number}} Place
 * @typedef {{tilt_deg: number, low_mm: number | null, high_mm: number | null}} Interval
 *
 * @typedef {object} Coverage
 * @property {MethodCoverage} coverage  of the chosen method, filled
 * @property {MethodCoverage | null} other  of the other method, outlined
 * @property {{lowMm: number, highMm: number} | null} wish
 * @property {Place[]} frames  to be pictured
 * @property {(Place & {share: number})[]} dots  of a simulated map
 */

import { bandRuns, layersOf, logTicks, widestOf } from "../shared/coverageLogic.js";
import { length } from "../shared/formatLogic.js";

export const MARGIN = { l: 64, r: 14, t: 8, b: 44 };
const TILT_STEP_DEG = 15;
/** @type {Record<string, string>} */
const LAYER_COLOURS = { outline: "ink-2" };

/**
 * @param {Coverage} shown
 * @param {Frame} frame
 * @param {Colours} colour
 * @returns {Chart}
 */
export function coverageChart({ coverage, other, wish, frames, dots }, frame, colour) {
  const layers = (/** @type {MethodCoverage} */ { spans, ...rest }) =>
    // The whole sign lies over most of a layer: under it, the layer's colour stays.
    layersOf({ spans, ...rest }).reverse().map((layer) => {
      const own = colour(LAYER_COLOURS[layer] ?? layer);
      return { layer, own, outline: outlineOf(frame, spans.filter((span) => span.layer === layer)) };
    });
  const areas = layers(coverage).map(({ layer, own, outline }) => ({
    ...line("area", own, 1.5), ...outline, fill: "toself", fillcolor: faint(own, layer === "outline" ? 0.16 : 0.28),
  }));
  const runs = bandRuns(coverage);
  const bands = runs.map((run) => ({
    ...line("dead band", colour("warn"), 1.5), ...outlineOf(frame, run), fill: "toself",
    fillcolor: faint(colour("warn"), 0.25),
  }));
  const outlines = (other ? layers(other) : []).map(({ own, outline }) => ({
    ...line("outline", own, 1.5, "dash"), ...outline,
  }));
  const wishes = (wish ? [wish.lowMm, wish.highMm] : []).map((height) => ({
    ...line("wish", colour("accent"), 2, "dot"), x: [0, frame.mostDeg], y: [height, height].map(within(frame)),
  }));
  return {
    data: [...areas, ...bands, ...outlines, ...wishes, dotsOf(dots, frame, colour), placesOf(frames, frame, colour)],
    layout: { ...axes(frame), annotations: runs.length ? [bandName(runs.flat(), frame, colour)] : [] },
  };
}

/** @param {string} name @param {string} color @param {number} width @param {string} [dash] */
const line = (name, color, width, dash = "solid") =>
  ({ type: "scatter", mode: "lines", name, line: { color, width, dash } });

/** @param {string} colour  as rgb(…) @param {number} alpha */
const faint = (colour, alpha) => colour.replace(/^rgb\((.*)\)$/, `rgba($1, ${alpha})`);

/** Heights beyond the chart lie on its border. @param {Frame} frame */
const within = ({ lowMm, highMm }) => (/** @type {number | null} */ heightMm) =>
  Math.min(highMm, Math.max(lowMm, Number(heightMm)));

/** @param {Frame} frame */
function axes({ lowMm, highMm, mostDeg }) {
  const tilts = Array.from({ length: Math.floor(mostDeg / TILT_STEP_DEG) + 1 }, (_, at) => at * TILT_STEP_DEG);
  const heights = logTicks(lowMm, highMm);
  return {
    margin: MARGIN,
    showlegend: false,
    xaxis: {
      title: "tilt of the camera", range: [0, mostDeg], tickvals: tilts, ticktext: tilts.map((tilt) => `${tilt}°`),
      zeroline: false,
    },
    yaxis: {
      type: "log", range: [lowMm, highMm].map(Math.log10), tickvals: heights, zeroline: false,
      ticktext: heights.map((height) => length(height).replace(/\.0+(?= )/, "")),
    },
  };
}

/**
 * Round intervals of heights: up one side and down the other, anew after tilts that have none.
 * @param {Frame} frame
 * @param {Interval[]} spans  by tilt
 * @returns {{x: (number | null)[], y: (number | null)[]}}
 */
export function outlineOf(frame, spans) {
  /** @type {Interval[][]} */
  const runs = [[]];
  for (const span of spans) {
    if (span.low_mm === null) runs.push([]);
    else runs[runs.length - 1].push(span);
  }
  /** @type {(number | null)[]} */
  const x = [];
  /** @type {(number | null)[]} */
  const y = [];
  for (const run of runs.filter((each) => each.length)) {
    const back = run.toReversed();
    if (x.length) [x, y].forEach((list) => list.push(null));
    x.push(...[...run, ...back, run[0]].map((span) => span.tilt_deg));
    const heights = [...run.map((span) => span.high_mm), ...back.map((span) => span.low_mm), run[0].high_mm];
    y.push(...heights.map(within(frame)));
  }
  return { x, y };
}

/** @param {import("../shared/coverageLogic.js").DeadBand[]} bands @param {Frame} frame @param {Colours} colour */
function bandName(bands, frame, colour) {
  const { tilt_deg: tilt, low_mm: low, high_mm: high } = widestOf(bands);
  const isLate = tilt > frame.mostDeg / 2;
  return {
    text: "dead band", x: tilt, y: (Math.log10(low) + Math.log10(high)) / 2, showarrow: false,
    xanchor: isLate ? "right" : "left", xshift: isLate ? -6 : 6, font: { size: 11, weight: 600, color: colour("warn") },
  };
}

/** @param {Coverage["dots"]} dots @param {Frame} frame @param {Colours} colour */
const dotsOf = (dots, frame, colour) => ({
  type: "scatter", mode: "markers", name: "simulated", cliponaxis: false,
  x: dots.map((dot) => dot.tiltDeg), y: dots.map((dot) => within(frame)(dot.heightMm)),
  marker: {
    size: 10, line: { color: colour("surface"), width: 1.5 },
    color: dots.map(({ share }) => colour(share >= 1 ? "ok" : share > 0 ? "warn" : "bad")),
  },
});

/** @param {Place[]} places @param {Frame} frame @param {Colours} colour */
const placesOf = (places, frame, colour) => ({
  type: "scatter", mode: "markers", name: "place", cliponaxis: false,
  x: places.map((place) => place.tiltDeg), y: places.map((place) => within(frame)(place.heightMm)),
  marker: { symbol: "cross-thin", size: 16, line: { color: colour("ink"), width: 2 } },
});
