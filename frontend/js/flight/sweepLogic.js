/**
 * One parameter over several values: which values, and what came out.
 *
 * @typedef {import("../server/tuningApi.js").Parameter} Parameter
 * @typedef {import("../server/tuningApi.js").Sweep} Sweep
 * @typedef {import("../shared/components/plot.js").Chart} Chart
 */

import { framesInWords, number } from "../shared/formatLogic.js";
import { positionOf, valueAt } from "../shared/workbench/paramsLogic.js";

export const MOST_VALUES = 12;
// Of a range far wider than what anybody would set: so much less and more than usual.
const BESIDE = 4;

/**
 * A range to begin with, about the usual value.
 * @param {Parameter} parameter
 * @returns {{from: number, to: number}}
 */
export function usualRange({ low, high, unit, default: usual }) {
  const value = Number(usual);
  if (unit === "log10") return { from: Math.max(low, 3 * value), to: Math.min(high, value / 3) };
  if (value > 0) return { from: Math.max(low, value / BESIDE), to: Math.min(high, value * BESIDE) };
  return { from: low, to: high };
}

/**
 * Values from one to another as a slider has them, evenly spaced along it.
 * @param {Parameter} parameter
 * @param {{from: number, to: number, count: number}} range
 * @returns {(number | boolean)[]}
 */
export function valuesBetween(parameter, { from, to, count }) {
  if (parameter.kind === "bool") return [false, true];
  const [start, end] = [from, to].map((value) => positionOf(parameter, value));
  const inner = Array.from({ length: Math.max(count - 2, 0) }, (_, at) => valueAt(parameter, start + ((end - start) * (at + 1)) / (count - 1)));
  return [...new Set([from, ...inner, to])].sort((a, b) => a - b);
}

/**
 * What is wrong with a range; empty where nothing is.
 * @param {Parameter} parameter
 * @param {{from: number, to: number, count: number}} range
 */
export function rangeFault({ kind, low, high }, { from, to, count }) {
  if (kind === "bool") return "";
  if (![from, to].every(Number.isFinite)) return "Two numbers, please.";
  if (kind === "int" && ![from, to].every(Number.isInteger)) return "Whole numbers, please.";
  if (from >= to) return "From must be less than to.";
  if (from < low || to > high) return `From ${low} to ${high}.`;
  return Number.isInteger(count) && count >= 2 && count <= MOST_VALUES ? "" : `2 to ${MOST_VALUES} values.`;
}

/**
 * How far it is, and what is best of it.
 * @param {Sweep} sweep
 * @returns {string}
 */
export function sweepInWords({ state, error, values, won, lost, frames_done: done, frames_total: total }) {
  if (state === "failed") return error ?? "The sweep failed.";
  const read = `${number(done)} of ${number(total)} frames read`;
  if (state === "queued" || state === "running") return `${read} …`;
  const gain = values.map((_, at) => won[at] - lost[at]);
  const best = gain.indexOf(Math.max(...gain));
  const end = state === "cancelled" ? `Stopped: ${read}. ` : "";
  if (!done) return end.trim() || `${read}.`;
  if (gain[best] <= 0) return `${end}No value wins more frames than it loses.`;
  const losing = lost[best] ? `loses ${number(lost[best])}` : "loses none";
  return `${end}${values[best]} wins ${number(won[best])} and ${losing}: most of these values.`;
}

/** @param {number | boolean} value @param {string} unit @returns {string} a value of a parameter */
export const valueInWords = (value, unit) => (unit ? `${value} ${unit}` : String(value));

/**
 * Frames won upwards, lost ones downwards, a bar a value.
 * @param {Sweep} sweep
 * @param {string} unit  of the parameter; empty for a count
 * @param {import("../shared/components/plot.js").Colours} colour
 * @returns {Chart}
 */
export function sweepChart({ parameter, values, won, lost }, unit, colour) {
  const bar = (/** @type {string} */ name, /** @type {number[]} */ y, /** @type {string} */ ink) => ({
    type: "bar", name, x: values.map(String), y, customdata: values.map((_, at) => at), textposition: "none",
    text: values.map((value, at) => `${valueInWords(value, unit)}: ${framesInWords(Math.abs(y[at]))}`),
    marker: { color: ink }, hovertemplate: `%{text}<extra>${name}</extra>`,
  });
  const most = Math.max(...won, ...lost);
  const yaxis = { title: "Frames", tickformat: "d", ...(most < 6 ? { dtick: 1 } : {}), ...(most ? {} : { range: [-1, 1] }) };
  return {
    data: [
      bar("Frames won", won, colour("ok")),
      bar("Frames lost", lost.map((count) => -count), colour("warn")),
    ],
    layout: { barmode: "relative", xaxis: { title: unit ? `${parameter} (${unit})` : parameter, type: "category" }, yaxis, showlegend: true },
  };
}
