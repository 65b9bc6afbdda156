/**
 * What a camera sees of a pad from straight above: cells in view and pixels a cell, by height.
 *
 * @typedef {import("./padLogic.js").PadView} PadView
 * @typedef {import("./padLogic.js").LayerView} LayerView
 * @typedef {import("../shared/components/plot.js").Chart} Chart
 * @typedef {import("../shared/components/plot.js").Colours} Colours
 * @typedef {import("../server/answers.js").View} View
 * @typedef {import("../server/answers.js").MethodCoverage} MethodCoverage
 *
 * @typedef {object} Curve
 * @property {string} channel
 * @property {number[]} cells  along the picture's shorter side, at each height
 * @property {number[]} pixels  along a cell
 */

import { heightRange, logTicks } from "../shared/coverageLogic.js";
import { compact, length } from "../shared/formatLogic.js";

/** Of the chart within its place, pixels. */
export const MARGIN = { l: 40, r: 10, t: 6, b: 40 };
const STEPS = 60;

/**
 * @param {PadView} pad
 * @param {View} view
 * @param {number} heightMm
 * @returns {{channel: string, cells: number, pixels: number}[]}  the finest layer first
 */
export function seenFrom(pad, view, heightMm) {
  const side = Math.min(view.width_px, view.height_px);
  return [...pad.layers]
    .sort((a, b) => a.cellMm - b.cellMm)
    .map((layer) => {
      const pixels = (view.focal_px * layer.cellMm) / heightMm;
      return { channel: layer.channel, cells: Math.min(side / pixels, layer.rows, layer.cols), pixels };
    });
}

/**
 * @param {{lowMm: number, highMm: number}} range
 * @returns {number[]}  heights in even ratios, both ends among them
 */
export function heightsOf({ lowMm, highMm }) {
  return Array.from({ length: STEPS + 1 }, (_, at) => lowMm * (highMm / lowMm) ** (at / STEPS));
}

/**
 * @param {PadView} pad
 * @param {View} view
 * @param {number} heightMm
 * @returns {string}  for example "1.30 m: red 61 cells of 14 px, blue 12 of 70 px"
 */
export function seenInWords(pad, view, heightMm) {
  const parts = seenFrom(pad, view, heightMm).map(
    ({ channel, cells, pixels }) => `${channel} ${compact(cells, 1)} cells of ${compact(pixels, 1)} px`,
  );
  return `${length(heightMm)}: ${parts.join(", ")}`;
}

/**
 * @param {PadView} pad
 * @param {View} view
 * @param {MethodCoverage} coverage
 * @param {Colours} colour
 * @returns {Chart}
 */
export function viewChart(pad, view, coverage, colour) {
  const range = heightRange([coverage]);
  const heights = heightsOf(range);
  const seen = heights.map((height) => seenFrom(pad, view, height));
  const channels = seen[0].map(({ channel }) => channel);
  const curve = (/** @type {number} */ at, /** @type {"cells" | "pixels"} */ what) => ({
    type: "scatter", mode: "lines", x: heights, y: seen.map((layers) => layers[at][what]),
    name: `${channels[at]}, ${what === "cells" ? "cells in view" : "pixels a cell"}`,
    line: { color: colour(channels[at]), width: 2, dash: what === "cells" ? "solid" : "dot" },
  });
  const bands = coverage.dead_bands.filter((band) => band.tilt_deg === 0);
  // The chart is narrow: whole powers of ten are enough to read it by.
  const ticks = logTicks(range.lowMm, range.highMm).filter((tick) => Number.isInteger(Math.log10(tick)));
  return {
    data: channels.flatMap((_, at) => [curve(at, "cells"), curve(at, "pixels")]),
    layout: {
      margin: MARGIN,
      showlegend: false,
      xaxis: {
        type: "log", range: [range.lowMm, range.highMm].map(Math.log10), title: "height",
        tickvals: ticks, ticktext: ticks.map((tick) => (tick < 1000 ? `${compact(tick)} mm` : `${compact(tick / 1000)} m`)),
        tickangle: 0, zeroline: false,
      },
      yaxis: { type: "log", dtick: 1, zeroline: false },
      shapes: bands.map((band) => shade(band.low_mm, band.high_mm, colour("warn"))),
      annotations: bands.map((band) => ({
        text: "dead band", x: (Math.log10(band.low_mm) + Math.log10(band.high_mm)) / 2, y: 1, yref: "paper",
        yanchor: "top", showarrow: false, font: { size: 11, color: colour("warn") },
      })),
    },
  };
}

/** @param {number} low @param {number} high @param {string} fillcolor */
const shade = (low, high, fillcolor) => ({
  type: "rect", xref: "x", yref: "paper", x0: low, x1: high, y0: 0, y1: 1, fillcolor, opacity: 0.25,
  line: { width: 0 }, layer: "below",
});
