/**
 * Expected against read: what each cell should be and what the picture shows.
 *
 * @typedef {import("../../server/tuningApi.js").CellsAnswer} CellsAnswer
 * @typedef {import("../../server/tuningApi.js").LayerCells} LayerCells
 */

import { number } from "../formatLogic.js";

/** Rows of the table of wrong cells. */
export const MOST_ROWS = 200;

/**
 * The cell nearest to a place of the frame.
 * @param {LayerCells} layer
 * @param {{x: number, y: number}} at  frame pixels
 * @returns {number | null} its place in the columns
 */
export function cellAt(layer, at) {
  let best = null;
  let least = layer.cell_px * 0.75;
  for (let k = 0; k < layer.x.length; k += 1) {
    const off = Math.max(Math.abs(layer.x[k] - at.x), Math.abs(layer.y[k] - at.y));
    if (off < least) [least, best] = [off, k];
  }
  return best;
}

/** @param {LayerCells} layer @param {number} k */
export const isWrong = (layer, k) => layer.expected[k] !== layer.level[k];

/** How far a cell's grey value is beyond the nearest threshold. @param {LayerCells} layer @param {number} k */
export const margin = (layer, k) => Math.min(...layer.thresholds[k].map((value) => Math.abs(layer.grey[k] - value)));

/** @param {LayerCells} layer @param {number} k @returns {string} */
export function cellInWords(layer, k) {
  const { channel, row, column, expected, level, grey, thresholds } = layer;
  return (
    `${channel} cell, row ${row[k]}, column ${column[k]}: expected level ${expected[k]}, read ${level[k]}; ` +
    `grey ${number(grey[k], 1)} of 255, threshold ${thresholds[k].map((value) => number(value, 1)).join(", ")}`
  );
}

/**
 * The wrong cells, the surest ones first: those are covered or another pad's, the others blurred.
 * @param {LayerCells} layer
 * @returns {number[]}
 */
export function wrongCells(layer) {
  return layer.x
    .map((_, k) => k)
    .filter((k) => isWrong(layer, k))
    .sort((a, b) => margin(layer, b) - margin(layer, a));
}

const ALIKE = 0.9;
const CLEARLY = 0.08;
/** Cells below it are not to be told from their neighbours. */
const SMALL_PX = 2;

/**
 * What the cells say, in a sentence.
 * @param {LayerCells} layer
 * @param {boolean} [isCarried]  with the pose of another frame
 * @returns {string}
 */
export function verdictOf(layer, isCarried = false) {
  const [own, ...others] = layer.fits;
  const best = others.reduce((a, b) => (b.share > a.share ? b : a), own);
  const share = (/** @type {number} */ value) => `${number(100 * value, 1)} %`;
  const told = `${share(own.share)} of ${number(layer.read)} ${layer.channel} cells agree`;
  if (best !== own && best.share > own.share + CLEARLY && best.share > 0.7) {
    const turn = best.quarter_turns ? ` and turned by ${90 * best.quarter_turns}°` : "";
    const how = best.mirrored ? `mirrored${turn}` : `turned by ${90 * best.quarter_turns}°`;
    return `${told}; ${how} it would be ${share(best.share)}: the pad seems ${how}.`;
  }
  if (own.share > ALIKE) return `${told}.`;
  return `${told}, ${patch(layer, isCarried)}.`;
}

/** Whether the wrong cells lie together. @param {LayerCells} layer @param {boolean} isCarried */
function patch(layer, isCarried) {
  const wrong = layer.x.map((_, k) => isWrong(layer, k));
  const at = new Map(layer.row.map((row, k) => [`${row},${layer.column[k]}`, k]));
  let pairs = 0;
  let alike = 0;
  layer.row.forEach((row, k) => {
    if (!wrong[k]) return;
    for (const beside of [`${row + 1},${layer.column[k]}`, `${row},${layer.column[k] + 1}`]) {
      const other = at.get(beside);
      if (other === undefined) continue;
      pairs += 1;
      alike += Number(wrong[other]);
    }
  });
  const chance = layer.wrong / Math.max(layer.read, 1);
  const isSmall = layer.cell_px < SMALL_PX;
  if (chance > 0.4 && isSmall) return `no more than chance: its cells of ${number(layer.cell_px, 1)} px are too small to be read`;
  // A pose that is off by a cell makes chance of all cells.
  if (chance > 0.4 && isCarried) return "no more than chance: the camera has moved by a cell of this layer or more since that frame";
  if (chance > 0.4) return "no more than chance: another pad, or another place on it";
  const together = pairs ? alike / pairs : 0;
  return together > Math.min(0.9, 1.5 * chance)
    ? "the wrong ones lie together: covered, or glare there"
    : "the wrong ones are spread over it: blurred, or too small";
}
