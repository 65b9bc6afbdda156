/**
 * The cell under the pointer, in words and figures.
 *
 * @typedef {import("./padLogic.js").PadView} PadView
 * @typedef {import("./padLogic.js").CellPlace} CellPlace
 */

import { number } from "../shared/formatLogic.js";
import { cellAt, layersOfView, padFrame, windowCode } from "./padLogic.js";

/** Codes longer than this say nothing to a reader. */
const MAX_DIGITS = 24;

/**
 * @param {PadView} pad
 * @param {string} view  "print" or a channel
 * @param {{x: number, y: number}} place  page mm
 * @param {CellPlace} cell  of the finest layer shown
 * @param {{row: number, col: number}} window  round that cell
 * @returns {string}
 */
export function placeInWords(pad, view, place, cell, window) {
  const cells = layersOfView(pad, view).map((layer) => cellAt(layer, place.x, place.y, pad));
  const parts = cells.map((found) =>
    found ? `${found.layer.channel} row ${found.row}, column ${found.col}: level ${found.level}` : "",
  );
  const code = windowCode(cell.layer, window.row, window.col, pad.window, pad.levels).toString();
  if (code.length <= MAX_DIGITS) {
    parts.push(`${cell.layer.channel} window ${window.row}, ${window.col}: code ${code}`);
  }
  const { x, y } = padFrame(pad, place.x, place.y);
  parts.push(`X ${number(x, 1)}, Y ${number(y, 1)} mm`);
  return parts.filter(Boolean).join(" · ");
}
