/**
 * Draws the marks of a stage over its picture: lines by family, cells, outlines, axes.
 *
 * @typedef {import("../../server/tuningApi.js").Marks} Marks
 * @typedef {import("../../server/tuningApi.js").LayerCells} LayerCells
 * @typedef {import("../viewportLogic.js").Viewport} Viewport
 */

import { isWrong } from "./cellsLogic.js";

// As of the server's own pictures: told apart by lightness as well as by hue.
const FAMILIES = ["#ffbe46", "#3cc8ff"];
const NO_FAMILY = "#e8e8e8";
const DROPPED = "#ff8df2";
const RIGHT = "#5adc5a";
const WRONG = "#ff3c3c";
const OUTLINE = "#5adc5a";
const AXES = ["#ff5050", "#5adc5a", "#508cff"];
// Figures are written into cells of at least this many pixels.
const WRITTEN_PX = 44;

/**
 * @param {CanvasRenderingContext2D} context  in view pixels
 * @param {Marks} marks
 * @param {(x: number, y: number) => [number, number]} toView  of frame pixels
 * @param {number} scale  view pixels per frame pixel
 * @param {Marks["lines"][number] | null} lit  the line under the cursor
 */
export function paintMarks(context, marks, toView, scale, lit) {
  for (const line of marks.lines) paintLine(context, line, toView, line === lit);
  paintCells(context, marks, toView, scale);
  const radius = Math.min(Math.max(3 * scale, 0.5), 1.8);
  for (const [x, y, counts] of marks.points) dot(context, toView(x, y), radius, counts ? FAMILIES[1] : WRONG);
  for (const outline of marks.outlines) {
    context.strokeStyle = OUTLINE;
    context.lineWidth = 2;
    trace(context, [...outline, outline[0]], toView);
  }
  if (marks.axes) paintAxes(context, marks.axes, toView);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Marks["lines"][number]} line
 * @param {(x: number, y: number) => [number, number]} toView
 * @param {boolean} isLit
 */
function paintLine(context, { points, family, kind }, toView, isLit) {
  context.save();
  context.strokeStyle = kind === "dropped" ? DROPPED : family === null ? NO_FAMILY : FAMILIES[family];
  context.lineWidth = isLit ? 3 : kind === "inserted" ? 1 : 1.3;
  if (kind === "dropped") context.setLineDash([7, 5]);
  trace(context, points, toView);
  if (kind === "inserted") {
    // A ring at either end, so that an inserted line is told from a found one without its colour.
    for (const end of [points[0], points.at(-1)]) if (end) ring(context, toView(...end), 3);
  }
  context.restore();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Marks} marks
 * @param {(x: number, y: number) => [number, number]} toView
 * @param {number} scale
 */
function paintCells(context, { cells, cell_px: side }, toView, scale) {
  const radius = Math.min(Math.max(side * scale * 0.16, 0.7), 8);
  for (const [x, y, wrong] of cells) dot(context, toView(x, y), wrong ? radius * 1.6 : radius, wrong ? WRONG : RIGHT);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number][]} axes
 * @param {(x: number, y: number) => [number, number]} toView
 */
function paintAxes(context, [origin, ...ends], toView) {
  ends.forEach((end, k) => {
    for (const [color, width] of /** @type {[string, number][]} */ ([["#000", 5], [AXES[k], 2.5]])) {
      context.strokeStyle = color;
      context.lineWidth = width;
      trace(context, [origin, end], toView);
    }
  });
}

/**
 * Every cell as expected and as read: squares filled by their expected level, wrong ones ringed.
 * @param {CanvasRenderingContext2D} context
 * @param {{layer: LayerCells, levels: number}} cells
 * @param {(x: number, y: number) => [number, number]} toView
 * @param {number} scale
 * @param {number | null} lit
 */
export function paintComparison(context, { layer, levels }, toView, scale, lit) {
  const side = layer.cell_px * scale;
  const { width, height } = context.canvas.getBoundingClientRect();
  layer.x.forEach((x, k) => {
    const [left, top] = toView(x, layer.y[k]);
    if (left < -side || top < -side || left > width + side || top > height + side) return;
    const wrong = isWrong(layer, k);
    if (side >= 9) {
      const grey = Math.round((255 * layer.expected[k]) / Math.max(levels - 1, 1));
      context.fillStyle = `rgb(${grey} ${grey} ${grey})`;
      context.fillRect(left - side * 0.14, top - side * 0.14, side * 0.28, side * 0.28);
    }
    if (wrong || k === lit) {
      context.strokeStyle = wrong ? WRONG : "#fff";
      context.lineWidth = k === lit ? 3 : 2;
      ring(context, [left, top], Math.max(side * 0.4, 2.5));
    } else if (side < 9) dot(context, [left, top], 1, RIGHT);
    if (side >= WRITTEN_PX) write(context, `${layer.expected[k]}→${layer.level[k]} ${Math.round(layer.grey[k])}`, left, top + side * 0.4);
  });
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {string} text
 * @param {number} x
 * @param {number} y
 */
function write(context, text, x, y) {
  context.font = "11px ui-monospace, monospace";
  context.textAlign = "center";
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 75%)";
  context.strokeText(text, x, y);
  context.fillStyle = "#fff";
  context.fillText(text, x, y);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number][]} points
 * @param {(x: number, y: number) => [number, number]} toView
 */
function trace(context, points, toView) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(...toView(x, y));
  context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number]} at
 * @param {number} radius
 * @param {string} color
 */
function dot(context, [x, y], radius, color) {
  context.fillStyle = color;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number]} at
 * @param {number} radius
 */
function ring(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.stroke();
}

/**
 * The corners that were clicked so far.
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number][]} corners
 * @param {(x: number, y: number) => [number, number]} toView
 */
export function paintCorners(context, corners, toView) {
  context.strokeStyle = "#ffbe46";
  context.lineWidth = 2;
  trace(context, corners.length === 4 ? [...corners, corners[0]] : corners, toView);
  corners.forEach(([x, y], k) => {
    ring(context, toView(x, y), 6);
    write(context, String(k + 1), toView(x, y)[0], toView(x, y)[1] - 9);
  });
}
