/**
 * What the Plan page asks for and says: a wanted range of heights, advice, a map of success.
 *
 * @typedef {Record<string, string>} Texts
 * @typedef {import("../server/planApi.js").Advice} Advice
 * @typedef {import("../server/planApi.js").SuccessMap} SuccessMap
 * @typedef {import("../shared/coverageLogic.js").MethodCoverage} MethodCoverage
 */

import { heightRange, heightSteps } from "../shared/coverageLogic.js";
import { compact, length } from "../shared/formatLogic.js";

/** The wanted heights; the server's defaults for the lean and the reach. */
export const DEFAULT_WISH = Object.freeze({
  low_mm: "100", high_mm: "8000", lean_deg: "20", reach_mm: "200",
});
export const DEFAULT_MAP = Object.freeze({ axis: "tilt_deg", rows: "6", trials: "1" });

/** Columns of a map. */
const VALUES = /** @type {Record<string, number[]>} */ ({
  tilt_deg: [0, 15, 30, 45, 60], blur_px: [0, 2, 4, 8, 16],
});
const WISH_RANGES = /** @type {Record<string, [number, number, string]>} */ ({
  low_mm: [1, 1_000_000, "Lowest"],
  high_mm: [1, 1_000_000, "Highest"],
  lean_deg: [0, 60, "Largest lean"],
  reach_mm: [0, 1_000_000, "Off the centre"],
});
const MAP_RANGES = /** @type {Record<string, [number, number, string]>} */ ({
  rows: [1, 20, "Heights"], trials: [1, 10, "Pictures each"],
});

/**
 * @param {Texts} texts
 * @param {Record<string, [number, number, string]>} ranges
 * @returns {Texts} faults by field
 */
function faults(texts, ranges) {
  /** @type {Texts} */
  const errors = {};
  for (const [key, [least, most, label]] of Object.entries(ranges)) {
    const value = Number(texts[key]);
    if (texts[key].trim() === "" || !(value >= least && value <= most)) {
      errors[key] = `${label}: from ${compact(least)} to ${compact(most)}.`;
    }
  }
  return errors;
}

/**
 * @param {Texts} texts
 * @returns {{wish: Texts | null, errors: Texts}}  wish: as the server's query takes it
 */
export function parseWish(texts) {
  const errors = faults(texts, WISH_RANGES);
  if (!errors.low_mm && !errors.high_mm && Number(texts.low_mm) >= Number(texts.high_mm)) {
    errors.high_mm = "Highest: more than the lowest.";
  }
  const { lean_deg: tilt, ...rest } = texts;
  return { wish: Object.keys(errors).length ? null : { ...rest, tilt_deg: tilt }, errors };
}

/**
 * @param {Advice} advice
 * @returns {[string, string][]}
 */
export function adviceFacts(advice) {
  const { cells, cell_mm: cell, ratio, size_mm: side } = advice;
  const blue = ratio > 1 ? `, blue cells of ${compact(ratio * cell)} mm` : ", one layer";
  return [
    ["Red cells", `${cells} × ${cells}, ${compact(cell)} mm`],
    ["Ratio", `${ratio}${blue}`],
    ["Pad", `${compact(side)} × ${compact(side)} mm`],
    ["Reads", `${length(advice.low_mm)} … ${length(advice.high_mm)}`],
  ];
}

/** @param {Advice} advice @returns {string} address of the Design page with this pad in its form */
export function designLink({ window, levels, cells, cell_mm: cell, ratio }) {
  const texts = { window, levels, rows: cells, cols: cells, cell_mm: cell, ratio };
  const query = Object.entries(texts).map(([key, value]) => [key, String(value)]);
  return `/design?${new URLSearchParams(query)}`;
}

/**
 * The rows of a map, each a question of its own so that it fills as it is answered.
 * @param {Texts} texts
 * @param {MethodCoverage | null} coverage  heights a little beyond what it reads are looked at
 * @returns {{plan: {axis: string, heights_mm: number[], values: number[], trials: number} | null,
 *   errors: Texts}}
 */
export function parseMap(texts, coverage) {
  const errors = faults(texts, MAP_RANGES);
  if (Object.keys(errors).length || !coverage) return { plan: null, errors };
  const { lowMm, highMm } = heightRange([coverage]);
  const axis = texts.axis === "blur_px" ? "blur_px" : "tilt_deg";
  return {
    plan: {
      axis,
      heights_mm: heightSteps(lowMm, highMm, Math.round(Number(texts.rows))),
      values: VALUES[axis],
      trials: Math.round(Number(texts.trials)),
    },
    errors,
  };
}

/**
 * A map with one more row.
 * @param {SuccessMap | null} map
 * @param {SuccessMap} row
 * @returns {SuccessMap}
 */
export function withRow(map, row) {
  if (!map) return row;
  return {
    ...map,
    heights_mm: [...map.heights_mm, ...row.heights_mm],
    success: [...map.success, ...row.success],
    wrong: [...map.wrong, ...row.wrong],
  };
}

/**
 * The places of a map over tilts, for the chart.
 * @param {SuccessMap | null} map
 * @returns {{tiltDeg: number, heightMm: number, share: number}[]}
 */
export function dotsOf(map) {
  if (map?.axis !== "tilt_deg") return [];
  return map.heights_mm.flatMap((heightMm, row) =>
    map.values.map((tiltDeg, col) => ({ tiltDeg, heightMm, share: map.success[row][col] })),
  );
}

/** @param {string} axis @param {number} value @returns {string} a column's head */
export const valueInWords = (axis, value) => (axis === "tilt_deg" ? `${value}°` : `${value} px`);

/**
 * The query of a form's texts that differ from its defaults, under a prefix.
 * @param {Texts} texts
 * @param {Readonly<Texts>} defaults
 * @param {string} prefix
 * @returns {Texts}
 */
export function toQuery(texts, defaults, prefix) {
  return Object.fromEntries(
    Object.entries(defaults)
      .filter(([key, text]) => texts[key] !== text)
      .map(([key]) => [prefix + key, texts[key]]),
  );
}

/** @param {URLSearchParams} query @param {Readonly<Texts>} defaults @param {string} prefix @returns {Texts} */
export function fromQuery(query, defaults, prefix) {
  return Object.fromEntries(
    Object.entries(defaults).map(([key, text]) => [key, query.get(prefix + key) ?? text]),
  );
}
