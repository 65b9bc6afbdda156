/**
 * Draws a frame with the pad where a pose says that it lies.
 *
 * @typedef {import("../../server/flightsApi.js").OutlineLine} OutlineLine
 *
 * @typedef {object} Picture
 * @property {ImageBitmap | HTMLImageElement} image
 * @property {number} scale  pixels of the frame per pixel of the image
 * @property {number} width  of the frame, pixels
 * @property {number} height
 */

const COLOURS = { side: "#ffdc00", x: "#ff4d4d", y: "#3ddc5a", z: "#5a9bff" };

/**
 * @param {HTMLCanvasElement} canvas
 * @param {number} shownWidth  CSS pixels
 * @param {Picture} picture
 * @param {OutlineLine[]} lines
 */
export function paintFrame(canvas, shownWidth, { image, scale, width, height }, lines) {
  const pixels = Math.round(shownWidth * (window.devicePixelRatio || 1));
  if (!pixels) return;
  const size = [pixels, Math.max(1, Math.round((pixels * height) / width))];
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const perPixel = canvas.width / width;
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, image.width * scale * perPixel, image.height * scale * perPixel);
  drawLines(context, lines);
}

/** @param {CanvasRenderingContext2D} context @param {OutlineLine[]} lines */
function drawLines(context, lines) {
  const { width, height } = context.canvas;
  const thick = Math.max(2, width / 500);
  context.lineJoin = "round";
  for (const [colour, stroke] of /** @type {[string | null, number][]} */ ([["#000000", thick + 2], [null, thick]])) {
    for (const { role, points } of lines) {
      context.beginPath();
      for (const [x, y] of points) context.lineTo(x * width, y * height);
      context.strokeStyle = colour ?? COLOURS[role];
      context.lineWidth = stroke;
      context.stroke();
    }
  }
}
