/**
 * The timeline of a flight: which frames stand where, and what a column holds.
 *
 * @typedef {import("../server/answers.js").Column} Column
 * @typedef {import("../server/answers.js").Timeline} Timeline
 *
 * @typedef {object} Part  of a flight
 * @property {number} first  frame number
 * @property {number} last  within
 */

import { clock, length, number, percent } from "../shared/formatLogic.js";

export const OUTCOMES = ["red", "green", "blue", "outline", "failed", "bearing"];
const FAILED = OUTCOMES.indexOf("failed");
const BEARING = OUTCOMES.indexOf("bearing");
const LEAST_FRAMES = 20;

/**
 * All frames that a flight may have.
 * @param {{request: {first_frame?: number, end_frame?: number | null, stride?: number},
 *   sources?: {frames?: number}[]}} flight
 * @returns {Part & {stride: number} | null} null until its files were looked into
 */
export function wholeOf({ request, sources = [] }) {
  const frames = sources.reduce((sum, source) => sum + (source.frames ?? 0), 0);
  if (!frames) return null;
  const { first_frame: first = 0, end_frame: end = null, stride = 1 } = request;
  const stop = Math.min(end ?? frames, frames) - 1;
  return { first, last: first + Math.floor((stop - first) / stride) * stride, stride };
}

/** @param {Part} part */
const sizeOf = (part) => part.last - part.first + 1;

/**
 * @param {Part} part
 * @param {number} frame
 * @returns {number} 0 … 1, the middle of the frame's place
 */
export const placeOf = (part, frame) => (frame - part.first + 0.5) / sizeOf(part);

/**
 * The frame that was read nearest to a place.
 * @param {Part} part
 * @param {number} place  0 … 1
 * @param {Part & {stride: number}} whole
 * @returns {number}
 */
export function frameAt(part, place, whole) {
  const raw = part.first + place * sizeOf(part) - 0.5;
  return nearestFrame(raw, whole);
}

/**
 * @param {number} frame
 * @param {Part & {stride: number}} whole
 * @returns {number}
 */
export function nearestFrame(frame, { first, last, stride }) {
  const step = Math.round((frame - first) / stride);
  return Math.min(Math.max(first + step * stride, first), last);
}

/**
 * Zoom so that the place keeps its frame; null is the whole flight.
 * @param {Part} part
 * @param {number} factor  above 1 shows less
 * @param {number} place  0 … 1
 * @param {Part} whole
 * @returns {Part | null}
 */
export function zoomPart(part, factor, place, whole) {
  const size = Math.max(sizeOf(part) / factor, Math.min(LEAST_FRAMES, sizeOf(whole)));
  if (size >= sizeOf(whole)) return null;
  const fixed = part.first + place * sizeOf(part);
  return fitPart(fixed - place * size, size, whole);
}

/** @param {number} start @param {number} size @param {Part} whole @returns {Part} */
function fitPart(start, size, whole) {
  const rounded = Math.max(1, Math.round(size));
  const first = Math.round(Math.min(Math.max(start, whole.first), whole.last + 1 - rounded));
  return { first, last: first + rounded - 1 };
}

/**
 * The part that shows a frame, moved as little as needed.
 * @param {Part | null} part
 * @param {number} frame
 * @param {Part} whole
 * @returns {Part | null}
 */
export function partWith(part, frame, whole) {
  if (!part || (frame >= part.first && frame <= part.last)) return part;
  return fitPart(frame - sizeOf(part) / 2, sizeOf(part), whole);
}

/**
 * A part for the address.
 * @param {Part | null} part
 * @returns {string | null}
 */
export const partToText = (part) => (part ? `${part.first}-${part.last}` : null);

/** @param {string | null} text @returns {Part | null} */
export function partFromText(text) {
  const found = /^(\d{1,9})-(\d{1,9})$/.exec(text ?? "");
  if (!found || Number(found[2]) < Number(found[1])) return null;
  return { first: Number(found[1]), last: Number(found[2]) };
}

/** @param {Column} column @returns {number} frames in it */
export const countOf = (column) => column.outcomes.reduce((sum, count) => sum + count, 0);

/** @param {Column} column @returns {number} */
export const failedOf = (column) => column.outcomes[FAILED];

/** @param {Column} column @returns {number} of which range and bearing alone can be used */
export const bearingOf = (column) => column.outcomes[BEARING] ?? 0;

/**
 * The heights that the columns span, 0 among them, lest a hover look like a flight to the moon.
 * @param {Column[][]} runs
 * @returns {{low: number, high: number} | null} mm
 */
export function heightRange(...runs) {
  let high = -Infinity;
  let low = 0;
  for (const column of runs.flat()) {
    high = Math.max(high, column.z_max_mm ?? -Infinity);
    low = Math.min(low, column.z_min_mm ?? 0);
  }
  return Number.isFinite(high) ? { low, high: Math.max(high, low + 1) } : null;
}

/**
 * The column that holds a frame.
 * @param {Timeline} timeline
 * @param {number} frame
 * @returns {Column | undefined}
 */
export function columnOf(timeline, frame) {
  const wanted = Math.floor((frame - timeline.first_frame) / timeline.frames_per_column);
  return timeline.columns.find((column) => column.column === wanted);
}

/**
 * What is under the pointer.
 * @param {Column | undefined} column
 * @param {number} frame
 * @returns {string}
 */
export function columnInWords(column, frame) {
  if (!column) return `frame ${number(frame)}: not read`;
  const { first_frame: first, last_frame: last, time_s: time, z_min_mm: low, z_max_mm: high } = column;
  const parts = [first === last ? `frame ${number(first)}` : `frames ${number(first)} – ${number(last)}`];
  if (time !== null) parts.push(clock(time));
  if (low !== null && high !== null) {
    const same = length(low) === length(high);
    parts.push(same ? length(high) : `${length(low)} – ${length(high)}`);
  }
  const [count, failed] = [countOf(column), failedOf(column)];
  const bearing = bearingOf(column);
  if (count === 1 && !bearing) parts.push(failed ? "no pose" : OUTCOMES[column.outcomes.findIndex(Boolean)]);
  if (count > 1) parts.push(failed ? `${number(failed)} without a pose` : `all ${number(count)} with a pose`);
  if (bearing) parts.push(`${count > 1 ? `${number(bearing)} with ` : ""}range and bearing only`);
  return parts.join(" · ");
}

/**
 * The share of frames with a pose, column by column.
 * @param {Timeline} timeline
 * @returns {{ok: number, count: number}}
 */
export function tallyOf({ columns }) {
  const count = columns.reduce((sum, column) => sum + countOf(column), 0);
  return { ok: count - columns.reduce((sum, column) => sum + failedOf(column), 0), count };
}

/**
 * Round heights for the lines of a grid.
 * @param {{low: number, high: number}} range  mm
 * @returns {number[]} mm
 */
export function heightMarks({ low, high }) {
  const power = 10 ** Math.floor(Math.log10((high - low) / 2));
  const step = [5, 2, 1].map((factor) => factor * power).find((each) => 2 * each <= high - low) ?? power;
  const marks = [];
  for (let mark = Math.ceil(low / step) * step; mark <= high; mark += step) marks.push(mark);
  return marks;
}

/** @param {Timeline} timeline @returns {string} for screen readers */
export function timelineInWords(timeline) {
  const { ok, count } = tallyOf(timeline);
  return `${number(count)} frames shown, ${percent(ok, count)} with a pose`;
}
