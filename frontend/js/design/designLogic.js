/**
 * What the Design page says of a pad, and how a stored pad fills the form.
 *
 * @typedef {import("./specLogic.js").PadSpec} PadSpec
 * @typedef {import("./padLogic.js").PadView} PadView
 */

import { compact, number, size } from "../shared/formatLogic.js";
import { levelShares } from "./padLogic.js";
import { bigNumber, DEFAULT_SPEC, sheetSize, specToTexts } from "./specLogic.js";

/**
 * What is known of a pad before it is grown.
 * @param {import("../server/planApi.js").PadBounds | null} bounds
 * @param {number} mostCells  that a pad may have along a side
 * @returns {{possible: string, capacity: string, largest: string, outlook: string}}  capacity for
 *   example "14 641 of 322 638"
 */
export function boundsInWords(bounds, mostCells) {
  if (!bounds) return { possible: "–", capacity: "–", largest: "–", outlook: "" };
  const { windows_needed: needed, log10_at_most: most, largest_square: side, outlook } = bounds;
  const isLong = outlook === "long";
  return {
    possible: bigNumber(bounds.log10_possible ?? 0),
    capacity: `${number(needed)} of ${most === null ? "none" : bigNumber(most)}`,
    largest: side >= mostCells ? "as large as may be" : `${number(side)} × ${number(side)} cells`,
    outlook: isLong ? "Near the bound: the search may take long, or not end in its time." : "",
  };
}

/**
 * What goes with a table or picture of a field, which does not say it itself.
 * @param {Record<string, string>} texts  the form's
 * @returns {Record<string, string>}
 */
export function tableSizes(texts) {
  const sizes = ["window", "cell_mm", "ratio", "quiet_mm"]
    .filter((key) => texts[key]?.trim() && Number.isFinite(Number(texts[key])))
    .map((key) => [key, texts[key].trim()]);
  return { layers: texts.layers ?? DEFAULT_SPEC.layers, ...Object.fromEntries(sizes) };
}

/** @param {PadSpec} spec @returns {string} */
export function sheetInWords(spec) {
  const { width, height } = sheetSize(spec);
  return size(width, height);
}

/**
 * @param {PadView} pad
 * @param {string | null} [id]  under which the server keeps it
 * @returns {import("../shared/components/facts.js").Facts}
 */
export function padFacts(pad, id) {
  /** @type {import("../shared/components/facts.js").Facts} */
  const facts = [["Size", size(pad.widthMm, pad.heightMm)]];
  if (pad.quietMm) facts.push(["Quiet margin", `${compact(pad.quietMm, 2)} mm`]);
  facts.push(["Window", `${pad.window} × ${pad.window} cells`], ["Grey levels", String(pad.levels)]);
  for (const layer of pad.layers) {
    const name = layer.channel.charAt(0).toUpperCase() + layer.channel.slice(1);
    facts.push([`${name} cells`, `${layer.cols} × ${layer.rows}, ${compact(layer.cellMm, 3)} mm`]);
    const bright = 100 * (levelShares(layer, pad.levels).at(-1) ?? 0);
    facts.push([`${name} at full level`, `${number(bright, 1)} %`]);
  }
  if (id) facts.push(["Pad's id", id, id]);
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
    // Of an unknown distance no more is claimed than that windows differ.
    distance: String(summary.distance ?? 1),
    visible_lines: String(file.visible_lines ?? DEFAULT_SPEC.visible_lines),
    layers: layerFields(file, fine, others[0]),
    method: summary.method === "growth" ? "growth" : DEFAULT_SPEC.method,
  };
}

/**
 * How a pad's layers were made: as its file says, else as its fields show.
 * @param {import("./padLogic.js").PadFile} file
 * @param {{codes: string[]}} fine
 * @param {{codes: string[]} | undefined} coarse
 * @returns {string}
 */
function layerFields(file, fine, coarse) {
  if (file.layer_fields || !coarse) return file.layer_fields ?? DEFAULT_SPEC.layers;
  const isCorner = coarse.codes.every((row, place) => fine.codes[place]?.startsWith(row));
  return isCorner ? "paper" : "independent";
}
