/**
 * One view of a stage: its picture where it lies in the frame, the original behind it, its marks.
 *
 * @typedef {import("./looker.js").Picture} Picture
 * @typedef {import("./workbenchLogic.js").Place} Place
 * @typedef {import("../../server/tuningApi.js").LayerCells} LayerCells
 *
 * @typedef {object} ViewState
 * @property {Picture | null} picture
 * @property {Picture | null} original  of the same channel
 * @property {Place | null} place
 * @property {{width: number, height: number}} image
 * @property {number} opacity  of the stage over the original, 0 … 1
 * @property {boolean} difference  the absolute difference of the two instead
 * @property {{x: number, y: number} | null} cursor  pixels from the frame's corner
 * @property {{layer: LayerCells, levels: number} | null} cells
 * @property {number | null} litCell
 * @property {import("../../server/tuningApi.js").Line | null} litLine
 * @property {[number, number][]} corners
 */

import { makeZoomable, fromMiddle } from "../components/zoomable.js";
import { toSheet, toView } from "../viewportLogic.js";
import { paintComparison, paintCorners, paintMarks } from "./marksPainter.js";
import { placeOf, viewportOf } from "./workbenchLogic.js";

// A press that moves by less is a click.
const CLICK_PX = 4;

/**
 * @param {HTMLElement} element  holds a canvas; takes the pointer and the keys
 * @param {object} events
 * @param {(place: Place | null) => void} events.onPlace
 * @param {(at: {x: number, y: number} | null) => void} events.onCursor
 * @param {(at: {x: number, y: number}) => void} events.onClick
 */
export function mountStageView(element, { onPlace, onCursor, onClick }) {
  const canvas = /** @type {HTMLCanvasElement} */ (element.querySelector("canvas"));
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  /** @type {ViewState | null} */
  let state = null;
  let painting = 0;
  /** @type {{bitmap: ImageBitmap, data: ImageData} | null} */
  let pixels = null;
  /** @type {{x: number, y: number} | null} */
  let pressed = null;

  const size = () => ({ width: element.clientWidth, height: element.clientHeight });
  const viewport = () => (state ? viewportOf(state.place, state.image, size()) : null);

  makeZoomable(element, {
    current: viewport,
    change: (moved) => state && onPlace(placeOf(moved, state.image, size())),
    reset: () => onPlace(null),
  });

  /** @param {PointerEvent} event */
  function placeUnder(event) {
    const seen = viewport();
    if (!state || !seen) return null;
    const at = toSheet(seen, fromMiddle(element, event));
    const isInside = at.x >= 0 && at.y >= 0 && at.x < state.image.width && at.y < state.image.height;
    return isInside ? at : null;
  }
  element.addEventListener("pointermove", (event) => onCursor(placeUnder(event)));
  element.addEventListener("pointerleave", () => onCursor(null));
  element.addEventListener("pointerdown", (event) => {
    pressed = { x: event.clientX, y: event.clientY };
  });
  element.addEventListener("pointerup", (event) => {
    const moved = pressed ? Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) : Infinity;
    const at = placeUnder(event);
    if (at && event.button === 0 && moved < CLICK_PX) onClick(at);
    pressed = null;
  });
  new ResizeObserver(() => repaint()).observe(element);

  function repaint() {
    painting ||= requestAnimationFrame(() => {
      painting = 0;
      paint();
    });
  }

  function paint() {
    const seen = viewport();
    const { width, height } = size();
    if (!state || !seen || !width) return;
    const ratio = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const at = (/** @type {number} */ x, /** @type {number} */ y) => {
      const { x: left, y: top } = toView(seen, { x, y });
      return /** @type {[number, number]} */ ([left + width / 2, top + height / 2]);
    };
    // Marks are in frame pixels, of which (0, 0) is the first one's centre.
    const atPixel = (/** @type {number} */ x, /** @type {number} */ y) => at(x + 0.5, y + 0.5);
    paintPictures(context, state, at);
    const { picture, cells, corners, cursor, litCell, litLine } = state;
    if (picture?.marks && !cells) paintMarks(context, picture.marks, atPixel, seen.scale, litLine);
    if (cells) paintComparison(context, cells, atPixel, seen.scale, litCell);
    if (corners.length) paintCorners(context, corners, atPixel);
    if (cursor) crosshair(context, at(cursor.x, cursor.y), width, height);
  }

  return {
    element,
    size,
    /** @param {ViewState} next */
    update(next) {
      state = next;
      repaint();
    },
    /** The picture's own value under the cursor: one number or three (red, green, blue), or null. */
    value() {
      const picture = state?.picture;
      if (!state?.cursor || !picture?.bitmap || !picture.part) return null;
      if (pixels?.bitmap !== picture.bitmap) pixels = { bitmap: picture.bitmap, data: dataOf(picture.bitmap) };
      return valueIn(pixels.data, picture.part, state.cursor);
    },
  };
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {ViewState} state
 * @param {(x: number, y: number) => [number, number]} at
 */
function paintPictures(context, { picture, original, opacity, difference }, at) {
  if (original && (opacity < 1 || difference)) draw(context, original, at);
  context.save();
  if (difference) context.globalCompositeOperation = "difference";
  else context.globalAlpha = opacity;
  if (picture) draw(context, picture, at);
  context.restore();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Picture} picture
 * @param {(x: number, y: number) => [number, number]} at
 */
function draw(context, { bitmap, part }, at) {
  if (!bitmap || !part) return;
  const [left, top] = at(part[0], part[1]);
  const [right, bottom] = at(part[2], part[3]);
  context.imageSmoothingEnabled = (right - left) / bitmap.width < 2;
  context.drawImage(bitmap, left, top, right - left, bottom - top);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number]} at
 * @param {number} width
 * @param {number} height
 */
function crosshair(context, [x, y], width, height) {
  context.lineWidth = 1;
  for (const [color, off] of /** @type {[string, number][]} */ ([["rgb(0 0 0 / 60%)", 1], ["rgb(255 255 255 / 85%)", 0]])) {
    context.strokeStyle = color;
    context.beginPath();
    context.moveTo(0, y + off);
    context.lineTo(width, y + off);
    context.moveTo(x + off, 0);
    context.lineTo(x + off, height);
    context.stroke();
  }
}

/** @param {ImageBitmap} bitmap */
function dataOf(bitmap) {
  const sheet = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (sheet.getContext("2d", { willReadFrequently: true }));
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height);
}

/**
 * @param {ImageData} data
 * @param {import("../../server/tuningApi.js").Part} part
 * @param {{x: number, y: number}} at
 * @returns {[number, number, number] | null}
 */
function valueIn({ data, width, height }, [left, top, right, bottom], at) {
  const x = Math.floor(((at.x - left) / (right - left)) * width);
  const y = Math.floor(((at.y - top) / (bottom - top)) * height);
  if (x < 0 || y < 0 || x >= width || y >= height) return null;
  const first = 4 * (y * width + x);
  return [data[first], data[first + 1], data[first + 2]];
}
