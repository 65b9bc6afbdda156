/**
 * How a pad is printed: the form's defaults, checks and address, and what a plan of sheets says.
 *
 * @typedef {import("./padLogic.js").PadView} PadView
 * @typedef {import("../server/answers.js").SheetPlan} SheetPlan
 * @typedef {import("../server/answers.js").PadShape} PadShape
 *
 * @typedef {Record<string, string>} Texts
 *
 * @typedef {import("../server/planApi.js").Crosstalk & {kept: boolean}} StripReading
 */

import { compact, number, size } from "../shared/formatLogic.js";

/** The server's defaults, but for the paper: most printers at hand take A4. */
export const DEFAULT_PRINT = Object.freeze({
  paper: "A4",
  custom: "",
  orientation: "auto",
  margin_mm: "5",
  joint: "butt",
  overlap_mm: "10",
  seams: "cells",
  header: "",
  footer: "",
  qr: "true",
  assembly_map: "true",
  outline_mm: "0",
  ink: "rgb",
  dpi: "150",
});
const SHEET_KEYS = ["paper", "orientation", "margin_mm", "joint", "overlap_mm", "seams"];
/** What each form takes beside what concerns sheets. */
const KEYS_OF_FORM = /** @type {Record<string, string[]>} */ ({
  pdf: [...SHEET_KEYS, "header", "footer", "qr", "assembly_map", "outline_mm", "ink"],
  "strip.pdf": ["paper", "margin_mm", "ink"],
  png: ["dpi"],
});
const RANGES = /** @type {Record<string, [number, number, string]>} */ ({
  margin_mm: [0, 1000, "Printer margin"],
  overlap_mm: [0.1, 1000, "Overlap"],
  outline_mm: [0, 100, "Outline"],
  dpi: [1, 2400, "Resolution"],
});
const CUSTOM = /^(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)$/;
const RULER_MM = 200;

/**
 * Check the form's texts.
 * @param {Texts} texts
 * @returns {{options: Texts | null, errors: Texts}}  options as the server takes them
 */
export function parsePrint(texts) {
  /** @type {Texts} */
  const errors = {};
  for (const [key, [least, most, label]] of Object.entries(RANGES)) {
    const value = Number(texts[key]);
    if (texts[key].trim() === "" || !(value >= least && value <= most)) {
      errors[key] = `${label}: from ${compact(least)} to ${compact(most)}.`;
    }
  }
  const { custom, ...options } = texts;
  if (texts.paper === "custom") {
    const found = CUSTOM.exec(custom.trim());
    if (found) options.paper = `${found[1]}x${found[2]}`;
    else errors.custom = "Write width × height in mm, for example 914 × 5000.";
  }
  return { options: Object.keys(errors).length ? null : options, errors };
}

/**
 * The options that spread a pad over sheets, as the server's body.
 * @param {Texts} options
 * @returns {Record<string, string | number>}
 */
export function sheetOptions(options) {
  const own = options.paper === "own";
  return Object.fromEntries(
    SHEET_KEYS.filter((key) => !(own && key === "margin_mm")).map((key) => [
      key,
      key.endsWith("_mm") ? Number(options[key]) : options[key],
    ]),
  );
}

/**
 * The query of a file's address: what the form takes and is not the server's default.
 * @param {string} form
 * @param {Texts} options
 * @returns {string}  empty, or begins with a question mark
 */
export function fileQuery(form, options) {
  const own = options.paper === "own";
  const keys = (KEYS_OF_FORM[form] ?? []).filter((key) => {
    if (key === "paper") return form === "strip.pdf" || !own;
    if (key === "margin_mm" && own) return false;
    return options[key] !== DEFAULT_PRINT[/** @type {keyof typeof DEFAULT_PRINT} */ (key)];
  });
  // A test strip on a page of its own size has no room for a printer's margin.
  const value = (/** @type {string} */ key) =>
    form === "strip.pdf" && key === "paper" && own ? "A4" : options[key];
  const query = new URLSearchParams(keys.map((key) => [key, value(key)])).toString();
  return query ? `?${query}` : "";
}

/** @param {URLSearchParams} query @returns {Texts} */
export function printFromQuery(query) {
  return Object.fromEntries(
    Object.entries(DEFAULT_PRINT).map(([key, text]) => [key, query.get(key) ?? text]),
  );
}

/** @param {Texts} texts @returns {Texts} what differs from the defaults */
export function printToQuery(texts) {
  return Object.fromEntries(
    Object.entries(DEFAULT_PRINT)
      .filter(([key, text]) => texts[key] !== text)
      .map(([key]) => [key, texts[key]]),
  );
}

/** @param {PadView} pad @returns {PadShape} */
export function shapeOfPad(pad) {
  return {
    window: pad.window,
    levels: pad.levels,
    quiet_mm: pad.quietMm,
    layers: pad.layers.map(({ channel, rows, cols, cellMm }) => ({
      channel, rows, cols, cell_mm: cellMm,
    })),
  };
}

/**
 * What a plan says, for a reader.
 * @param {SheetPlan} plan
 * @returns {[string, string][]}
 */
export function planFacts(plan) {
  const paper = plan.paper === "own size" ? "the pad's own size" : `paper size ${plan.paper}, ${plan.orientation}`;
  const page = size(...plan.page_mm);
  if (plan.count === 1) return [["Sheets", `1 of ${paper}`], ["Paper", size(...plan.paper_mm)]];
  return [
    ["Sheets", `${number(plan.count)} of ${paper}`],
    ["Sheet names", `${plan.sheets[0].name} to ${plan.sheets[plan.sheets.length - 1].name}`],
    ["Joined", `${plan.rows} × ${plan.cols} sheets, ${page}`],
    ["Total paper", `${compact(plan.paper_m2, 2)} m²`],
    ["Seams", plan.on_cells ? "on cell edges" : "through cells"],
  ];
}

/**
 * What one cell of each layer measures on paper.
 * @param {PadView} pad
 * @param {[number, number]} scale  measured over nominal size
 * @returns {[string, string][]}
 */
export function cellFacts(pad, scale) {
  return pad.layers.map(({ channel, cellMm }) => {
    const [x, y] = scale.map((part) => compact(part * cellMm, 3));
    return [`One ${channel} cell`, x === y ? `${x} mm` : `${x} × ${y} mm`];
  });
}

/**
 * What is sent where rulers were read; null where a reading is no length that can be.
 * @param {string} x
 * @param {string} y
 * @returns {{x_mm: number, y_mm: number, ruler_mm: number} | null}
 */
export function readings(x, y) {
  const [xMm, yMm] = [Number(x), Number(y)];
  const fine = (/** @type {number} */ mm) => mm >= RULER_MM / 2 && mm <= RULER_MM * 2;
  return fine(xMm) && fine(yMm) ? { x_mm: xMm, y_mm: yMm, ruler_mm: RULER_MM } : null;
}

/**
 * A measured scale as the rulers read.
 * @param {[number, number]} scale
 * @returns {[string, string]}
 */
export function rulerTexts(scale) {
  const [x, y] = scale.map((part) => String(Math.round(part * RULER_MM * 1000) / 1000));
  return [x, y];
}

/**
 * The mixture that a stored pad's pictures are un-mixed by.
 * @param {import("../server/api.js").PadSummary} pad
 * @returns {StripReading | null}
 */
export const keptStrip = ({ crosstalk }) => crosstalk && { ...crosstalk, kept: true };

/**
 * What a photo of the test strip says.
 * @param {StripReading} strip
 * @returns {{facts: [string, string][], warnings: string[], note: string, kept: boolean}}
 */
export function stripInWords({ matrix, red_separation: red, blue_separation: blue, warnings, kept }) {
  const percent = (/** @type {number} */ share) => `${number(100 * share)} %`;
  return {
    facts: [
      ["Red stands out by", percent(red)],
      ["Blue stands out by", percent(blue)],
      ["Red in the blue channel", percent(matrix[2][0])],
      ["Blue in the red channel", percent(matrix[0][2])],
    ],
    warnings: warnings.map((text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`),
    note: kept
      ? "Kept with the pad: its pictures are un-mixed by it. Another printer or camera needs a photo of its own."
      : "Not kept: pictures are read as they are.",
    kept,
  };
}
