/**
 * Wheel, drag, pinch and keys over an element, turned into viewports.
 *
 * @typedef {import("../viewportLogic.js").Viewport} Viewport
 *
 * @typedef {object} ZoomableOptions
 * @property {() => Viewport | null} current  null where there is nothing to look at
 * @property {(viewport: Viewport) => void} change
 * @property {() => void} reset  back to the whole sheet
 */

import { keyMove, pan, zoomAt } from "../viewportLogic.js";

const ARROW_STEP = 60;
// A wheel's notch is 100 or so; a touchpad's pinch arrives as a wheel with Ctrl and small steps.
const WHEEL_RATE = 0.0018;
const PINCH_RATE = 0.012;

/**
 * @param {HTMLElement} element
 * @param {ZoomableOptions} options
 */
export function makeZoomable(element, options) {
  element.addEventListener("wheel", (event) => onWheel(element, options, event), {
    passive: false,
  });
  element.addEventListener("dblclick", () => {
    if (options.current()) options.reset();
  });
  element.addEventListener("keydown", (event) => {
    const viewport = options.current();
    if (!viewport || event.ctrlKey || event.metaKey || event.altKey) return;
    const moved = keyMove(viewport, event.key, event.shiftKey ? 4 * ARROW_STEP : ARROW_STEP);
    if (!moved) return;
    event.preventDefault();
    event.stopPropagation();
    if (moved === "fit") options.reset();
    else options.change(moved);
  });
  followPointers(element, options);
}

/**
 * A pointer's place in view pixels from the element's middle.
 * @param {HTMLElement} element
 * @param {{clientX: number, clientY: number}} event
 * @returns {{x: number, y: number}}
 */
export function fromMiddle(element, event) {
  const box = element.getBoundingClientRect();
  return {
    x: event.clientX - box.left - box.width / 2,
    y: event.clientY - box.top - box.height / 2,
  };
}

/**
 * @param {HTMLElement} element
 * @param {ZoomableOptions} options
 * @param {WheelEvent} event
 */
function onWheel(element, options, event) {
  const viewport = options.current();
  if (!viewport) return;
  event.preventDefault();
  const rate = event.ctrlKey ? PINCH_RATE : WHEEL_RATE;
  const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? event.deltaY * 33 : event.deltaY;
  options.change(zoomAt(viewport, Math.exp(-pixels * rate), fromMiddle(element, event)));
}

/**
 * One pointer drags, two pinch.
 * @param {HTMLElement} element
 * @param {ZoomableOptions} options
 */
function followPointers(element, options) {
  /** @type {Map<number, {x: number, y: number}>} */
  const pointers = new Map();
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !options.current()) return;
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, fromMiddle(element, event));
  });
  element.addEventListener("pointermove", (event) => {
    const viewport = options.current();
    if (!pointers.has(event.pointerId) || !viewport) return;
    const before = spread([...pointers.values()]);
    pointers.set(event.pointerId, fromMiddle(element, event));
    const after = spread([...pointers.values()]);
    const moved = pan(viewport, after.x - before.x, after.y - before.y);
    options.change(before.size ? zoomAt(moved, after.size / before.size, after) : moved);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    element.addEventListener(end, (event) => {
      pointers.delete(/** @type {PointerEvent} */ (event).pointerId);
    });
  }
}

/**
 * Middle and distance of the pointers; the distance is 0 for a single one.
 * @param {{x: number, y: number}[]} points
 * @returns {{x: number, y: number, size: number}}
 */
function spread(points) {
  const [a, b = a] = points;
  return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y) };
}
