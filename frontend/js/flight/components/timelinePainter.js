/**
 * Paints a timeline on its canvas.
 *
 * @typedef {import("../timelineLogic.js").Timeline} Timeline
 * @typedef {import("../timelineLogic.js").Part} Part
 * @typedef {{left: number, top: number, width: number, height: number}} Box  CSS pixels
 */

import { length } from "../../shared/formatLogic.js";
import { countOf, failedOf, heightMarks, heightRange, OUTCOMES, placeOf } from "../timelineLogic.js";

const STRIP = 22;
const GAP = 6;
/** A single failed frame among hundreds must be seen. */
const LEAST_MARK = 4;

/**
 * @param {HTMLCanvasElement} canvas
 * @param {{timeline: Timeline | null, other: Timeline | null, part: Part | null, frame: number | null}} state
 */
export function paintTimeline(canvas, { timeline, other, part, frame }) {
  const context = canvas.getContext("2d");
  const { clientWidth: width, clientHeight: height } = canvas;
  if (!context || !width || !height) return;
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  context.scale(ratio, ratio);
  if (!timeline || !part) return;
  const colours = coloursOf(canvas);
  const strips = other ? 2 * STRIP + GAP / 2 : STRIP;
  const graph = { left: 0, top: 4, width, height: height - strips - GAP - 4 };
  paintHeights(context, graph, part, timeline, other, colours);
  const top = height - strips;
  paintOutcomes(context, { left: 0, top, width, height: STRIP }, part, timeline, colours);
  if (other) {
    const box = { left: 0, top: top + STRIP + GAP / 2, width, height: STRIP };
    paintOutcomes(context, box, part, other, colours);
  }
  if (frame !== null) paintCursor(context, placeOf(part, frame) * width, height, colours);
}

/** @type {Record<string, string> | null} */
let known = null;
document.addEventListener("themechange", () => {
  known = null;
});

/** @param {Element} element @returns {Record<string, string>} */
function coloursOf(element) {
  if (known) return known;
  const style = getComputedStyle(element);
  // A pair of colours is resolved only as a property that is one.
  const probe = document.createElement("span");
  element.parentElement?.append(probe);
  const resolve = (/** @type {string} */ name) => {
    probe.style.color = `var(${name})`;
    return getComputedStyle(probe).color;
  };
  const names = ["ink", "ink-3", "line", "red", "green", "blue", "accent", "failed", "surface"];
  const found = Object.fromEntries(names.map((name) => [name, resolve(`--${name}`)]));
  probe.remove();
  known = { ...found, outline: found.accent, font: style.fontFamily };
  return known;
}

/** @param {Timeline} timeline @param {Part} part @param {import("../timelineLogic.js").Column} column */
function spanOf(timeline, part, column) {
  const size = part.last - part.first + 1;
  const start = timeline.first_frame + column.column * timeline.frames_per_column;
  const end = Math.min(start + timeline.frames_per_column, timeline.last_frame + 1);
  return { from: (start - part.first) / size, to: (end - part.first) / size };
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Box} box
 * @param {Part} part
 * @param {Timeline} timeline
 * @param {Timeline | null} other
 * @param {Record<string, string>} colours
 */
function paintHeights(context, box, part, timeline, other, colours) {
  const range = heightRange(timeline.columns, other?.columns ?? []);
  if (!range) return;
  const y = (/** @type {number} */ mm) =>
    box.top + box.height * (1 - (mm - range.low) / (range.high - range.low));
  context.font = `11px ${colours.font}`;
  context.textBaseline = "bottom";
  for (const mark of heightMarks(range)) {
    context.fillStyle = colours.line;
    context.fillRect(box.left, Math.round(y(mark)), box.width, 1);
    context.fillStyle = colours["ink-3"];
    if (y(mark) > box.top + 12) context.fillText(length(mark), box.left + 2, y(mark) - 1);
  }
  if (other) strokeHeights(context, box, part, other, y, colours["ink-3"], 1);
  strokeHeights(context, box, part, timeline, y, colours.ink, 1.5);
}

/**
 * A line through the columns, broken where frames have no pose.
 * @param {CanvasRenderingContext2D} context
 * @param {Box} box
 * @param {Part} part
 * @param {Timeline} timeline
 * @param {(mm: number) => number} y
 * @param {string} colour
 * @param {number} lineWidth
 */
function strokeHeights(context, box, part, timeline, y, colour, lineWidth) {
  context.strokeStyle = colour;
  context.lineWidth = lineWidth;
  context.beginPath();
  let last = -2;
  for (const column of timeline.columns) {
    if (column.z_min_mm === null || column.z_max_mm === null) continue;
    const { from, to } = spanOf(timeline, part, column);
    const x = box.left + (box.width * (from + to)) / 2;
    if (column.column === last + 1) context.lineTo(x, y(column.z_max_mm));
    else context.moveTo(x - 0.75, y(column.z_max_mm));
    context.lineTo(x, y(column.z_min_mm));
    last = column.column;
  }
  context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Box} box
 * @param {Part} part
 * @param {Timeline} timeline
 * @param {Record<string, string>} colours
 */
function paintOutcomes(context, box, part, timeline, colours) {
  context.fillStyle = colours.line;
  context.fillRect(box.left, box.top, box.width, box.height);
  for (const column of timeline.columns) {
    const { from, to } = spanOf(timeline, part, column);
    const x = box.left + from * box.width;
    const wide = Math.max((to - from) * box.width, 1);
    // Columns as wide as a frame can be told apart.
    const shown = wide > 5 ? wide - 1 : wide + 0.5;
    paintShares(context, { left: x, top: box.top, width: shown, height: box.height }, column, colours);
  }
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Box} box
 * @param {import("../timelineLogic.js").Column} column
 * @param {Record<string, string>} colours
 */
function paintShares(context, { left, top, width, height }, column, colours) {
  const total = countOf(column);
  let y = top + height;
  column.outcomes.forEach((count, at) => {
    const high = (height * count) / total;
    context.fillStyle = colours[OUTCOMES[at]];
    context.fillRect(left, y - high, width, high);
    y -= high;
  });
  const failed = (height * failedOf(column)) / total;
  if (failed && failed < LEAST_MARK) context.fillRect(left, top, width, LEAST_MARK);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} x
 * @param {number} height
 * @param {Record<string, string>} colours
 */
function paintCursor(context, x, height, colours) {
  context.fillStyle = colours.surface;
  context.fillRect(x - 2, 0, 4, height);
  context.fillStyle = colours.ink;
  context.fillRect(x - 1, 0, 2, height);
  context.beginPath();
  context.arc(x, 4, 4, 0, 7);
  context.fill();
}
