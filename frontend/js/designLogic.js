/**
 * What the Design page says of a pad, and how a stored pad fills the form.
 *
 * @typedef {import("./specLogic.js").PadSpec} PadSpec
 * @typedef {import("./padLogic.js").PadView} PadView
 */

import { compact, number, size } from "./formatLogic.js";
import { levelShares } from "./padLogic.js";
import { bigNumber, capacity, DEFAULT_SPEC, sheetSize, specToTexts } from "./specLogic.js";

/**
 * How much of all codes the red layer's windows use.
 * @param {PadSpec} spec
 * @returns {string} for example "0.17 % of 8 388 608"
 */
export function capacityInWords(spec) {
  const { log10Codes, share } = capacity(spec);
  const percent = 100 * share;
  const used = percent >= 0.01 ? `${compact(percent, 2)} %` : "below 0.01 %";
  return `${used} of ${bigNumber(log10Codes)}`;
}

/** @param {PadSpec} spec @returns {string} */
export function sheetInWords(spec) {
  const { width, height } = sheetSize(spec);
  return size(width, height);
}

/**
 * @param {PadView} pad
 * @returns {[string, string][]}
 */
export function padFacts(pad) {
  /** @type {[string, string][]} */
  const facts = [["Size", size(pad.widthMm, pad.heightMm)]];
  if (pad.quietMm) facts.push(["Quiet margin", `${compact(pad.quietMm, 2)} mm`]);
  facts.push(["Window, levels", `${pad.window} × ${pad.window}, ${pad.levels}`]);
  for (const layer of pad.layers) {
    const name = layer.channel.charAt(0).toUpperCase() + layer.channel.slice(1);
    facts.push([`${name} cells`, `${layer.cols} × ${layer.rows}, ${compact(layer.cellMm, 3)} mm`]);
    const bright = 100 * (levelShares(layer, pad.levels).at(-1) ?? 0);
    facts.push([`${name} at full level`, `${number(bright, 1)} %`]);
  }
  return facts;
}

/**
 * The form's texts for a stored pad: what it was made from, as far as it says so.
 * @param {{name: string, window: number, levels: number, seed: number | null,
 *   method: string | null, unique: string | null, distance: number | null}} summary
 * @param {import("./padLogic.js").PadFile} file
 * @returns {Record<string, string>}
 */
export function textsOfPad(summary, file) {
  const [fine, ...others] = [...file.layers].sort((a, b) => a.cell_mm - b.cell_mm);
  return {
    ...specToTexts(DEFAULT_SPEC),
    name: summary.name,
    window: String(summary.window),
    levels: String(summary.levels),
    rows: String(fine.codes.length),
    cols: String(fine.codes[0].length),
    cell_mm: String(fine.cell_mm),
    quiet_mm: String(file.quiet_mm ?? 0),
    ratio: String(others.length ? Math.round(others[0].cell_mm / fine.cell_mm) : 1),
    seed: summary.seed === null ? "" : String(summary.seed),
    unique: summary.unique ?? DEFAULT_SPEC.unique,
    distance: String(summary.distance ?? DEFAULT_SPEC.distance),
    method: summary.method === "growth" ? "growth" : DEFAULT_SPEC.method,
  };
}
