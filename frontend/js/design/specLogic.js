/**
 * The specification of a pad: defaults, bounds, checks, and its form in the address.
 *
 * @typedef {import("../server/answers.js").PadSpec} PadSpec
 *
 * @typedef {Partial<Record<keyof PadSpec, string>>} SpecErrors
 *
 * @typedef {object} Bound  of a numeric field; the page's HTML holds them
 * @property {number} least
 * @property {number} most
 * @property {boolean} whole
 * @property {string} label
 *
 * @typedef {Record<string, Bound>} Bounds
 */

import { compact, number, powerOfTen } from "../shared/formatLogic.js";

/** @type {Readonly<PadSpec>} */
export const DEFAULT_SPEC = Object.freeze({
  name: "pad",
  window: 5,
  levels: 2,
  rows: 125,
  cols: 125,
  ratio: 5,
  cell_mm: 10,
  quiet_mm: 0,
  unique: "rotation",
  distance: 3,
  visible_lines: false,
  layers: "independent",
  method: "auto",
  seed: 1,
});

const CHOICES = {
  unique: ["rotation", "plain"],
  layers: ["independent", "paper"],
  method: ["auto", "growth"],
};
const MAX_NAME = 200;

/**
 * Check the form's texts.
 * @param {Record<string, string>} texts  a text for each field of a PadSpec
 * @param {Bounds} bounds  of the numeric fields
 * @returns {{spec: PadSpec | null, errors: SpecErrors}}  spec is null where there are errors
 */
export function parseSpec(texts, bounds) {
  /** @type {SpecErrors} */
  const errors = {};
  /** @type {Record<string, unknown>} */
  const spec = { ...DEFAULT_SPEC };
  for (const [key, bound] of Object.entries(bounds)) {
    const text = (texts[key] ?? "").trim();
    if (key === "seed" && text === "") {
      spec.seed = null;
      continue;
    }
    const fault = numberFault(bound, text);
    if (fault) errors[/** @type {keyof PadSpec} */ (key)] = fault;
    else spec[key] = Number(text);
  }
  for (const [key, allowed] of Object.entries(CHOICES)) {
    if (allowed.includes(texts[key])) spec[key] = texts[key];
  }
  spec.visible_lines = texts.visible_lines === "true";
  spec.name = (texts.name ?? "").trim() || DEFAULT_SPEC.name;
  if (String(spec.name).length > MAX_NAME) errors.name = `Use at most ${MAX_NAME} characters.`;
  const whole = /** @type {PadSpec} */ (spec);
  if (!Object.keys(errors).length) Object.assign(errors, relationFaults(whole));
  return { spec: Object.keys(errors).length ? null : whole, errors };
}

/**
 * @param {Bound} bound
 * @param {string} text
 * @returns {string | null}
 */
function numberFault({ least, most, whole, label }, text) {
  const value = Number(text);
  if (text === "" || !Number.isFinite(value)) return `${label}: enter a number.`;
  if (whole && !Number.isInteger(value)) return `${label}: enter a whole number.`;
  if (value < least || value > most) {
    return `${label}: from ${compact(least)} to ${compact(most)}.`;
  }
  return null;
}

/**
 * What a pad's code depends on: two specs with the same are the same code at two sizes.
 * @param {PadSpec} spec
 * @returns {string}
 */
export function codeOf({ name, cell_mm, quiet_mm, ...rest }) {
  return JSON.stringify(Object.entries(rest).sort());
}

/**
 * Faults that only two fields together have.
 * @param {PadSpec} spec
 * @returns {SpecErrors}
 */
function relationFaults(spec) {
  /** @type {SpecErrors} */
  const errors = {};
  const b = spec.window;
  if (spec.rows < b) errors.rows = `At least ${b} rows, or no ${b} × ${b} window fits.`;
  if (spec.cols < b) errors.cols = `At least ${b} columns, or no ${b} × ${b} window fits.`;
  if (spec.distance > b * b) errors.distance = `A window has only ${b * b} cells.`;
  if (Object.keys(errors).length) return errors;
  const short = Math.min(spec.rows, spec.cols);
  if (spec.ratio > 1 && Math.floor(short / spec.ratio) < b) {
    const most = Math.max(1, Math.floor(short / b));
    errors.ratio = `At most ${most}, so that a ${b} × ${b} window of blue cells fits.`;
  }
  const { windows, log10Codes } = capacity(spec);
  if (Math.log10(windows) > log10Codes) {
    errors.window =
      `${number(windows)} windows but only ${bigNumber(log10Codes)} codes: use a larger window, ` +
      "more levels or fewer cells.";
  }
  return errors;
}

/**
 * How many windows must differ, and how many codes there are for them.
 * @param {PadSpec} spec
 * @returns {{windows: number, log10Codes: number, share: number}}  share: windows over codes
 */
export function capacity(spec) {
  const b = spec.window;
  const windowsOf = (/** @type {number} */ rows, /** @type {number} */ cols) =>
    Math.max(0, rows - b + 1) * Math.max(0, cols - b + 1);
  const [blueRows, blueCols] = [spec.rows, spec.cols].map((n) => Math.floor(n / spec.ratio));
  const hasTwoFields = spec.ratio > 1 && spec.layers === "independent";
  const windows = windowsOf(spec.rows, spec.cols) + (hasTwoFields ? windowsOf(blueRows, blueCols) : 0);
  // Up to rotation four windows are one; the few that are alike when turned are left aside.
  const turns = spec.unique === "rotation" ? Math.log10(4) : 0;
  const log10Codes = b * b * Math.log10(spec.levels) - turns;
  return { windows, log10Codes, share: windows / 10 ** log10Codes };
}

/**
 * A count that may be too large to write out.
 * @param {number} log10
 * @returns {string}
 */
export function bigNumber(log10) {
  return log10 < 9 ? number(Math.floor(10 ** log10 + 1e-6)) : `about ${powerOfTen(log10)}`;
}

/**
 * Size on paper, quiet margin included.
 * @param {PadSpec} spec
 * @returns {{width: number, height: number}}  mm
 */
export function sheetSize(spec) {
  const margin = 2 * spec.quiet_mm;
  return { width: spec.cols * spec.cell_mm + margin, height: spec.rows * spec.cell_mm + margin };
}

/**
 * The fields that differ from the defaults, for the address.
 * @param {Record<string, string>} texts
 * @returns {Record<string, string>}
 */
export function specToQuery(texts) {
  /** @type {Record<string, string>} */
  const query = {};
  for (const [key, value] of Object.entries(specToTexts(DEFAULT_SPEC))) {
    if (texts[key] !== undefined && texts[key] !== value) query[key] = texts[key];
  }
  return query;
}

/**
 * The form's texts from an address.
 * @param {URLSearchParams} query
 * @returns {Record<string, string>}
 */
export function specFromQuery(query) {
  const texts = specToTexts(DEFAULT_SPEC);
  for (const key of Object.keys(texts)) {
    const value = query.get(key);
    if (value !== null) texts[key] = value;
  }
  return texts;
}

/**
 * @param {Readonly<PadSpec>} spec
 * @returns {Record<string, string>}
 */
export function specToTexts(spec) {
  return Object.fromEntries(
    Object.entries(spec).map(([key, value]) => [key, value === null ? "" : String(value)]),
  );
}

/**
 * How long to wait after a keystroke before the server grows a new preview: the more cells, the
 * dearer a needless run.
 * @param {PadSpec} spec
 * @returns {number}  ms
 */
export function previewDelay(spec) {
  return spec.rows * spec.cols > 100_000 ? 900 : 300;
}
