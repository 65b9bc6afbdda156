/**
 * What a calibration's figures say, in words.
 *
 * @typedef {import("../server/calibrationApi.js").Calibration} Calibration
 * @typedef {import("../server/calibrationApi.js").CalibrationResult} CalibrationResult
 * @typedef {import("../server/calibrationApi.js").CalibrationPicture} CalibrationPicture
 *
 * @typedef {{x: number, y: number, opacity: number, title: string}} MapCell
 */

import { compact, length, number } from "../shared/formatLogic.js";

// A map is full from here on.
const LEAST_SIGMA_PX = 0.5;

/** @param {Calibration | null} job */
export const isAtWork = (job) => job?.state === "queued" || job?.state === "running";

/** @param {Calibration} job */
export function progressInWords({ state, steps_done: done, steps_total: total }) {
  if (state === "queued") return "Waiting for a free worker …";
  return total ? `Step ${number(done)} of at most ${number(total)}` : "Reading the pictures …";
}

/**
 * What an order lacks, in words; empty where it lacks nothing.
 * @param {{pad: string, files: number}} order
 */
export function missingInWords({ pad, files }) {
  if (!pad) return "Choose the pad that was printed.";
  return files ? "" : "Add stills or a clip of it.";
}

/** @param {CalibrationResult} result @returns {{kind: "ok" | "warn", text: string}} */
export function verdictOf({ pictures, findings, rms_px: rms }) {
  const again = pictures.filter((picture) => picture.state !== "good").length;
  const fit = `residuals are ${compact(rms, 2)} px`;
  if (!findings.length && !again) return { kind: "ok", text: `A good calibration: ${fit}, and nothing is missing.` };
  const parts = [];
  if (findings.length) parts.push(findings.length === 1 ? "one thing is missing" : `${findings.length} things are missing`);
  if (again) parts.push(again === 1 ? "one picture should be taken again" : `${again} pictures should be taken again`);
  return { kind: "warn", text: `${fit[0].toUpperCase()}${fit.slice(1)}; ${parts.join(", and ")}.` };
}

/** @param {CalibrationResult} result @returns {[string, string][]} */
export function factsOf({ width, height, model, pictures, rms_px: rms, sigma_px: sigma }) {
  const seen = sigma.flat().filter((value) => value !== null);
  const most = Math.max(...seen);
  return [
    ["Size", `${number(width)} × ${number(height)} px`],
    ["Lens", model === "fisheye" ? "fisheye (equidistant)" : "radial and tangential"],
    ["Pictures", `${number(pictures.filter((picture) => picture.used).length)} of ${number(pictures.length)} used`],
    ["Residuals", `${compact(rms, 2)} px`],
    ["Least sure part", `± ${compact(most, 2)} px`],
  ];
}

/** @param {import("../server/calibrationApi.js").Parameter} parameter @returns {[string, string, string]} */
export function parameterRow({ name, value, sigma }) {
  const isPixels = ["fx", "fy", "cx", "cy"].includes(name);
  const decimals = isPixels ? 2 : 5;
  const unit = isPixels ? " px" : "";
  return [name, `${value.toFixed(decimals)}${unit}`, `± ${sigma.toFixed(decimals)}${unit}`];
}

/** @param {CalibrationPicture} picture */
export function pictureInWords({ range_mm: range, tilt_deg: tilt, patches, rms_px: rms, used }) {
  if (range === null || tilt === null) return "";
  const where = `from ${length(range)}, leaning ${number(tilt)}°`;
  return used ? `${where} · ${number(patches)} points · residuals ${compact(rms, 2)} px` : where;
}

/**
 * Cells of a map of the picture; the fuller, the more.
 * @param {number[][]} counts
 * @returns {MapCell[]}
 */
export function coverageCells(counts) {
  const most = Math.max(1, ...counts.flat());
  return cellsOf(counts, (count) => ({
    // By the root, so that a few points are seen beside many.
    opacity: Math.sqrt((count ?? 0) / most),
    title: count === 1 ? "1 point" : `${number(count ?? 0)} points`,
  }));
}

/**
 * Cells of a map of the picture; the fuller, the less sure.
 * @param {(number | null)[][]} sigma
 * @returns {MapCell[]}
 */
export function sigmaCells(sigma) {
  // Lenses that are sure everywhere look so.
  const most = Math.max(LEAST_SIGMA_PX, ...sigma.flat().filter((value) => value !== null));
  return cellsOf(sigma, (value) => ({
    opacity: value === null ? 0 : value / most,
    title: value === null ? "the lens shows nothing there" : `± ${compact(value, 2)} px`,
  }));
}

/**
 * @param {(number | null)[][]} rows
 * @param {(value: number | null) => {opacity: number, title: string}} shown
 */
const cellsOf = (rows, shown) =>
  rows.flatMap((row, y) => row.map((value, x) => ({ x, y, ...shown(value) })));
