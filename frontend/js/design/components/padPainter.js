/**
 * Paints a pad on a canvas; knows neither the page nor the pointer.
 *
 * @typedef {import("../padLogic.js").PadView} PadView
 * @typedef {import("../padLogic.js").LayerView} LayerView
 * @typedef {import("../../shared/viewportLogic.js").Viewport} Viewport
 *
 * @typedef {object} Mark
 * @property {LayerView} layer
 * @property {number} row  of the cell
 * @property {number} col
 * @property {{row: number, col: number}} window  its top-left cell
 *
 * @typedef {object} PairMark  two windows that are nearly alike
 * @property {LayerView} layer
 * @property {{row: number, col: number}[]} windows  their top-left cells
 */

import { layerPixels, layersOfView } from "../padLogic.js";
import { toView } from "../../shared/viewportLogic.js";

const GRID_FROM_PX = 10;
const DIGITS_FROM_PX = 26;
const LEAST_MARK_PX = 16;

/** @type {WeakMap<Uint8Array, HTMLCanvasElement>}  by the levels, which a new size keeps */
const sprites = new WeakMap();

/**
 * A layer as a picture of one pixel a cell, made once.
 * @param {LayerView} layer
 * @param {number} levels
 * @returns {HTMLCanvasElement}
 */
function sprite(layer, levels) {
  let canvas = sprites.get(layer.levels);
  if (!canvas) {
    canvas = document.createElement("canvas");
    canvas.width = layer.cols;
    canvas.height = layer.rows;
    const pixels = new ImageData(layerPixels(layer, levels), layer.cols, layer.rows);
    canvas.getContext("2d")?.putImageData(pixels, 0, 0);
    sprites.set(layer.levels, canvas);
  }
  return canvas;
}

/**
 * Match the canvas's pixels to the screen's.
 * @param {HTMLCanvasElement} canvas
 * @returns {{context: CanvasRenderingContext2D, width: number, height: number, ratio: number}}
 */
export function prepareCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, w, h);
  return { context, width, height, ratio };
}

/**
 * Paint a view of a pad.
 * @param {HTMLCanvasElement} canvas
 * @param {PadView} pad
 * @param {string} view  "print" or a channel
 * @param {Viewport} viewport  in millimetres of the page
 * @param {Mark | null} [mark]
 * @param {PairMark | null} [pair]
 */
export function paintPad(canvas, pad, view, viewport, mark = null, pair = null) {
  const { context, width, height, ratio } = prepareCanvas(canvas);
  /** @type {(x: number, y: number, w: number, h: number) => [number, number, number, number]} */
  const box = (x, y, w, h) => {
    const a = toView(viewport, { x, y });
    const b = toView(viewport, { x: x + w, y: y + h });
    const px = (/** @type {number} */ value, /** @type {number} */ extent) =>
      Math.round((value + extent / 2) * ratio);
    const [left, top] = [px(a.x, width), px(a.y, height)];
    return [left, top, px(b.x, width) - left, px(b.y, height) - top];
  };
  const quiet = pad.quietMm;
  context.fillStyle = "#fff";
  context.fillRect(...box(0, 0, pad.widthMm + 2 * quiet, pad.heightMm + 2 * quiet));
  context.fillStyle = "#000";
  context.fillRect(...box(quiet, quiet, pad.widthMm, pad.heightMm));
  const layers = layersOfView(pad, view);
  // Light adds up: that is how a camera sees the print.
  context.globalCompositeOperation = "lighter";
  for (const layer of layers) {
    context.imageSmoothingEnabled = layer.cellMm * viewport.scale * ratio < 2;
    context.imageSmoothingQuality = "high";
    const place = box(quiet, quiet, layer.cols * layer.cellMm, layer.rows * layer.cellMm);
    context.drawImage(sprite(layer, pad.levels), ...place);
  }
  context.globalCompositeOperation = "source-over";
  const screen = { context, box, ratio, width, height };
  // A grid of coarse cells alone, over fine ones, would look like part of the print.
  const isGridLegible = layers.length > 0 && layers[0].cellMm * viewport.scale >= GRID_FROM_PX;
  for (const layer of isGridLegible ? layers : []) {
    paintGrid(screen, pad, layer, viewport, layers.length === 1);
  }
  if (pair) paintPair(screen, pad, pair);
  if (mark) paintMark(screen, pad, mark);
}

/**
 * @typedef {object} Screen
 * @property {CanvasRenderingContext2D} context
 * @property {(x: number, y: number, w: number, h: number) => [number, number, number, number]} box
 * @property {number} ratio
 * @property {number} width
 * @property {number} height
 */

/**
 * Cell borders, and from a readable size on the levels themselves.
 * @param {Screen} screen
 * @param {PadView} pad
 * @param {LayerView} layer
 * @param {Viewport} viewport
 * @param {boolean} alone
 */
function paintGrid({ context, box, ratio, width, height }, pad, layer, viewport, alone) {
  const cellPx = layer.cellMm * viewport.scale;
  const range = (/** @type {number} */ at, /** @type {number} */ extent, /** @type {number} */ count) => {
    const half = extent / 2 / viewport.scale;
    const first = Math.floor((at - half - pad.quietMm) / layer.cellMm);
    const last = Math.ceil((at + half - pad.quietMm) / layer.cellMm);
    return [Math.max(0, first), Math.min(count, last)];
  };
  const [col0, col1] = range(viewport.x, width, layer.cols);
  const [row0, row1] = range(viewport.y, height, layer.rows);
  context.strokeStyle = "rgb(150 150 150 / 55%)";
  context.lineWidth = ratio;
  context.font = `${Math.round(Math.min(16, cellPx / 3) * ratio)}px ui-monospace, monospace`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (let row = row0; row < row1; row += 1) {
    for (let col = col0; col < col1; col += 1) {
      const [x, y, w, h] = cellBox(box, pad, layer, row, col, 1);
      context.strokeRect(x + ratio / 2, y + ratio / 2, w, h);
      if (alone && cellPx >= DIGITS_FROM_PX) {
        const level = layer.levels[row * layer.cols + col];
        // Full green is too bright for white digits.
        context.fillStyle = layer.channel === "green" && 2 * level >= pad.levels ? "#000" : "#fff";
        context.fillText(level.toString(36), x + w / 2, y + h / 2);
      }
    }
  }
}

/**
 * The cell under the pointer and the window round it.
 * @param {Screen} screen
 * @param {PadView} pad
 * @param {Mark} mark
 */
function paintMark({ context, box, ratio }, pad, mark) {
  const outlines = [
    cellBox(box, pad, mark.layer, mark.window.row, mark.window.col, pad.window),
    cellBox(box, pad, mark.layer, mark.row, mark.col, 1),
  ];
  for (const outline of outlines) strokeTwice(context, outline, 2 * ratio);
}

/**
 * Two windows, however small they are; the second dashed.
 * @param {Screen} screen
 * @param {PadView} pad
 * @param {PairMark} pair
 */
function paintPair({ context, box, ratio }, pad, { layer, windows }) {
  windows.forEach(({ row, col }, place) => {
    const [x, y, w, h] = cellBox(box, pad, layer, row, col, pad.window);
    const grow = Math.max(0, LEAST_MARK_PX * ratio - w) / 2;
    const dash = place ? [5 * ratio, 4 * ratio] : [];
    strokeTwice(context, [x - grow, y - grow, w + 2 * grow, h + 2 * grow], 3 * ratio, dash);
  });
}

/**
 * Yellow on black, which stands out from every colour of a print.
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number, number, number]} outline
 * @param {number} width
 * @param {number[]} [dash]
 */
function strokeTwice(context, outline, width, dash = []) {
  context.strokeStyle = "#000";
  context.lineWidth = 2 * width;
  context.strokeRect(...outline);
  context.setLineDash(dash);
  context.strokeStyle = "#ffe14d";
  context.lineWidth = width;
  context.strokeRect(...outline);
  context.setLineDash([]);
}

/**
 * @param {Screen["box"]} box
 * @param {PadView} pad
 * @param {LayerView} layer
 * @param {number} row
 * @param {number} col
 * @param {number} count  cells along the box's side
 */
function cellBox(box, pad, layer, row, col, count) {
  const cell = layer.cellMm;
  return box(pad.quietMm + col * cell, pad.quietMm + row * cell, count * cell, count * cell);
}
