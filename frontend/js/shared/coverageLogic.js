/**
 * Where a pad reads: charts of height against tilt, in figures that a picture only has to draw.
 *
 * @typedef {import("../server/answers.js").Method} Method
 * @typedef {import("../server/answers.js").Span} Span
 * @typedef {import("../server/answers.js").DeadBand} DeadBand
 * @typedef {import("../server/answers.js").MethodCoverage} MethodCoverage
 * @typedef {import("../server/answers.js").CoverageChart} CoverageChart
 *
 * @typedef {object} Frame  what a chart spans
 * @property {number} lowMm
 * @property {number} highMm
 * @property {number} mostDeg
 */

import { length } from "./formatLogic.js";

/** Tilts of the chart; the axis ends where lenses see the horizon. */
export const TILTS_DEG = Array.from({ length: 31 }, (_, place) => 2.5 * place);

/**
 * @param {CoverageChart | null} chart
 * @param {string} method
 * @returns {MethodCoverage | null}
 */
export const ofMethod = (chart, method) =>
  chart?.methods.find((each) => each.method === method) ?? null;

/** @param {MethodCoverage} coverage @returns {string[]} the finest layer first, the whole sign last */
export const layersOf = (coverage) => [...new Set(coverage.spans.map((span) => span.layer))];

/** @param {string} layer */
export const layerInWords = (layer) => (layer === "outline" ? "whole sign" : `${layer} layer`);

/**
 * Heights between which a chart shows everything, at whole steps of 1, 2, 5.
 * @param {MethodCoverage[]} methods
 * @returns {{lowMm: number, highMm: number}}
 */
export function heightRange(methods) {
  const spans = methods.flatMap((each) => each.spans).filter((span) => span.low_mm !== null);
  if (!spans.length) return { lowMm: 10, highMm: 10_000 };
  const low = Math.min(...spans.map((span) => Number(span.low_mm)));
  const high = Math.max(...spans.map((span) => Number(span.high_mm)));
  const ticks = logTicks(low / 10, high * 10);
  return {
    lowMm: ticks.filter((tick) => tick <= low).at(-1) ?? low,
    highMm: ticks.find((tick) => tick >= high) ?? high,
  };
}

/**
 * 1, 2 and 5 times powers of ten within a range.
 * @param {number} low
 * @param {number} high
 * @returns {number[]}
 */
export function logTicks(low, high) {
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    for (const digit of [1, 2, 5]) {
      // Powers of ten below one are not exact.
      const tick = Number((digit * 10 ** power).toPrecision(1));
      if (tick >= low && tick <= high) ticks.push(tick);
    }
  }
  return ticks;
}

/**
 * @param {Frame} frame
 * @param {number} across  0 … 1, from the left
 * @param {number} up  0 … 1
 * @returns {{tiltDeg: number, heightMm: number}} of a place, kept within the chart
 */
export function placeOf({ lowMm, highMm, mostDeg }, across, up) {
  const within = (/** @type {number} */ share) => Math.min(1, Math.max(0, share));
  return { tiltDeg: within(across) * mostDeg, heightMm: lowMm * (highMm / lowMm) ** within(up) };
}

const KEY_STEPS = /** @type {Record<string, [number, number]>} */ ({
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
});
const STEP_DEG = 2.5;
const STEP_RATIO = 1.1;

/**
 * Where an arrow key takes a place of the chart; null for other keys.
 * @param {{tiltDeg: number, heightMm: number}} place
 * @param {string} key
 * @param {Frame} frame
 * @returns {{tiltDeg: number, heightMm: number} | null}
 */
export function moved({ tiltDeg, heightMm }, key, { mostDeg, lowMm, highMm }) {
  const step = KEY_STEPS[key];
  if (!step) return null;
  return {
    tiltDeg: Math.min(mostDeg, Math.max(0, tiltDeg + step[0] * STEP_DEG)),
    heightMm: Math.min(highMm, Math.max(lowMm, heightMm * STEP_RATIO ** step[1])),
  };
}

/**
 * Dead bands from tilt to tilt: each joins the one beside it whose heights overlap with its own.
 * @param {MethodCoverage} coverage
 * @returns {DeadBand[][]}
 */
export function bandRuns(coverage) {
  const tilts = [...new Set(coverage.spans.map((span) => span.tilt_deg))].sort((a, b) => a - b);
  /** @type {DeadBand[][]} */
  const runs = [];
  tilts.forEach((tilt, place) => {
    for (const band of coverage.dead_bands.filter((each) => each.tilt_deg === tilt)) {
      const run = runs.find((each) => {
        const last = each[each.length - 1];
        return last.tilt_deg === tilts[place - 1] && last.low_mm < band.high_mm && band.low_mm < last.high_mm;
      });
      if (run) run.push(band);
      else runs.push([band]);
    }
  });
  return runs;
}

/** @param {DeadBand[]} bands  at least one @returns {DeadBand} */
export const widestOf = (bands) =>
  bands.reduce((a, b) => (b.high_mm / b.low_mm > a.high_mm / a.low_mm ? b : a));

/**
 * What the dead band means, at the least tilt that has one; empty where there is none.
 * @param {MethodCoverage | null} coverage
 * @returns {string}
 */
export function deadBandInWords(coverage) {
  const bands = coverage?.dead_bands ?? [];
  if (!bands.length) return "";
  const least = Math.min(...bands.map((each) => each.tilt_deg));
  const band = widestOf(bands.filter((each) => each.tilt_deg === least));
  const place = band.tilt_deg ? `At ${band.tilt_deg}° of tilt and more, f` : "F";
  return `${place}${band.message.slice(1)}.`;
}

/**
 * Heights that each layer, and the sign as a whole, reads from straight above.
 * @param {MethodCoverage} coverage
 * @returns {[string, string][]}
 */
export function heightFacts(coverage) {
  return coverage.spans
    .filter((span) => span.tilt_deg === 0)
    .map((span) => [capital(layerInWords(span.layer)), spanInWords(span)]);
}

/**
 * How well the chart's ends hold.
 * @param {string} method
 * @returns {string}
 */
export const surenessInWords = (method) =>
  method === "paper"
    ? "An area ends where half of the pictures are read in daylight: right to 13 % of height up to 30° of tilt. " +
      "Leaning, this method fades: beyond 45° some pictures are missed at any height, and of the whole sign's " +
      "a part is read far beyond the end."
    : "An area ends where half of the pictures are read in daylight: right to 10 % of height. Where " +
      "the camera leans by more than 45° over a pad too large to be seen as a whole, it reads higher than shown.";

/** @param {Span} span @returns {string} */
export const spanInWords = ({ low_mm: low, high_mm: high }) =>
  low === null || high === null ? "reads nowhere" : `${length(low)} … ${length(high)}`;

/**
 * What reads at a place of the chart.
 * @param {MethodCoverage} coverage
 * @param {{tiltDeg: number, heightMm: number}} place
 * @returns {string}
 */
export function placeInWords(coverage, { tiltDeg, heightMm }) {
  const readers = layersOf(coverage).filter((layer) => {
    const spans = coverage.spans.filter((span) => span.layer === layer);
    const near = spans.reduce((a, b) =>
      Math.abs(b.tilt_deg - tiltDeg) < Math.abs(a.tilt_deg - tiltDeg) ? b : a,
    );
    return near.low_mm !== null && heightMm >= near.low_mm && heightMm <= Number(near.high_mm);
  });
  const names = readers.map((layer) => (layer === "outline" ? "the whole sign" : layer));
  const what = names.length ? `${listed(names)} read${names.length > 1 ? "" : "s"}` : "nothing reads";
  return `${length(heightMm)}, tilt ${tiltDeg.toFixed(0)}°: ${what}`;
}

/** @param {string[]} words @returns {string} */
const listed = (words) => [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");

/** @param {string} word */
export const capital = (word) => word.charAt(0).toUpperCase() + word.slice(1);

/**
 * Even ratios of height, for a map of simulated frames.
 * @param {number} lowMm
 * @param {number} highMm
 * @param {number} count
 * @returns {number[]} from the highest down
 */
export function heightSteps(lowMm, highMm, count) {
  if (count < 2) return [Math.round(highMm)];
  return Array.from({ length: count }, (_, place) => {
    const height = highMm * (lowMm / highMm) ** (place / (count - 1));
    return Number(height.toPrecision(3));
  });
}
