/**
 * Panning and zooming over a sheet: of millimetres (a pad) or of pixels (a stage picture).
 *
 * @typedef {object} Viewport
 * @property {number} x  the sheet's place at the middle of the view
 * @property {number} y
 * @property {number} scale  view pixels per sheet unit
 *
 * @typedef {{width: number, height: number}} Size
 */

/**
 * The whole sheet in view.
 * @param {Size} sheet
 * @param {Size} view
 * @param {number} [border]  that stays free, pixels
 * @returns {Viewport}
 */
export function fit(sheet, view, border = 12) {
  const room = (/** @type {number} */ extent) => Math.max(8, extent - 2 * border);
  const scale = Math.min(room(view.width) / sheet.width, room(view.height) / sheet.height);
  return { x: sheet.width / 2, y: sheet.height / 2, scale };
}

/**
 * Keep the middle of the view on the sheet, and the scale between half the fit and `maxScale`.
 * @param {Viewport} viewport
 * @param {Size} sheet
 * @param {Size} view
 * @param {number} maxScale
 * @returns {Viewport}
 */
export function clamp(viewport, sheet, view, maxScale) {
  const least = fit(sheet, view).scale / 2;
  const within = (/** @type {number} */ value, /** @type {number} */ a, /** @type {number} */ b) =>
    Math.min(Math.max(value, a), b);
  return {
    x: within(viewport.x, 0, sheet.width),
    y: within(viewport.y, 0, sheet.height),
    scale: within(viewport.scale, least, Math.max(least, maxScale)),
  };
}

/**
 * Zoom so that the sheet's place under a point of the view stays there.
 * @param {Viewport} viewport
 * @param {number} factor
 * @param {{x: number, y: number}} point  view pixels from the view's middle
 * @returns {Viewport}
 */
export function zoomAt(viewport, factor, point) {
  const scale = viewport.scale * factor;
  return {
    x: viewport.x + point.x / viewport.scale - point.x / scale,
    y: viewport.y + point.y / viewport.scale - point.y / scale,
    scale,
  };
}

/**
 * Move the sheet by view pixels.
 * @param {Viewport} viewport
 * @param {number} dx
 * @param {number} dy
 * @returns {Viewport}
 */
export function pan(viewport, dx, dy) {
  return { ...viewport, x: viewport.x - dx / viewport.scale, y: viewport.y - dy / viewport.scale };
}

/**
 * The sheet's place under a point of the view.
 * @param {Viewport} viewport
 * @param {{x: number, y: number}} point  view pixels from the view's middle
 * @returns {{x: number, y: number}}
 */
export function toSheet(viewport, point) {
  return { x: viewport.x + point.x / viewport.scale, y: viewport.y + point.y / viewport.scale };
}

/**
 * A point of the view, from its middle, over a place of the sheet.
 * @param {Viewport} viewport
 * @param {{x: number, y: number}} place
 * @returns {{x: number, y: number}}
 */
export function toView(viewport, place) {
  return { x: (place.x - viewport.x) * viewport.scale, y: (place.y - viewport.y) * viewport.scale };
}

/**
 * The round length (1, 2 or 5 times a power of ten) whose bar is nearest below `longest` pixels.
 * @param {number} scale  pixels per unit
 * @param {number} longest  pixels
 * @returns {{units: number, pixels: number}}
 */
export function scaleBar(scale, longest) {
  const limit = longest / scale;
  const power = 10 ** Math.floor(Math.log10(limit));
  const units = [5, 2, 1].map((step) => step * power).find((step) => step <= limit) ?? power;
  return { units, pixels: units * scale };
}

/**
 * What a key does to a viewport; null where it does nothing.
 * @param {Viewport} viewport
 * @param {string} key  KeyboardEvent.key
 * @param {number} step  pixels for an arrow key
 * @returns {Viewport | "fit" | null}
 */
export function keyMove(viewport, key, step) {
  const middle = { x: 0, y: 0 };
  switch (key) {
    case "+": case "=": return zoomAt(viewport, 1.25, middle);
    case "-": case "_": return zoomAt(viewport, 0.8, middle);
    case "0": case "Home": return "fit";
    case "ArrowLeft": return pan(viewport, step, 0);
    case "ArrowRight": return pan(viewport, -step, 0);
    case "ArrowUp": return pan(viewport, 0, step);
    case "ArrowDown": return pan(viewport, 0, -step);
    default: return null;
  }
}

/**
 * A viewport for the address; null where it is the fit.
 * @param {Viewport | null} viewport
 * @returns {string | null}
 */
export function viewportToText(viewport) {
  if (!viewport) return null;
  return [viewport.x.toFixed(2), viewport.y.toFixed(2), viewport.scale.toPrecision(6)]
    .map((text) => String(Number(text))).join(",");
}

/**
 * @param {string | null} text
 * @returns {Viewport | null}
 */
export function viewportFromText(text) {
  const [x, y, scale] = (text ?? "").split(",").map((part) => (part ? Number(part) : NaN));
  if (![x, y, scale].every(Number.isFinite) || !(scale > 0)) return null;
  return { x, y, scale };
}
