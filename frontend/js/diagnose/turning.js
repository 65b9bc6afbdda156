/**
 * Pictures that lie turned by a quarter from how the camera was calibrated: told, and turned back.
 */

import { ApiError } from "../server/request.js";

/**
 * The frame's width and height, where a refusal says that it is turned.
 * @param {unknown} error
 * @returns {[number, number] | null}
 */
export function turnedSize(error) {
  if (!(error instanceof ApiError) || error.detail.turned !== true) return null;
  return /** @type {[number, number]} */ (error.detail.frame);
}

/**
 * The picture turned by a quarter, its pixels as they were.
 * @param {File} file
 * @param {[number, number]} size  as the server saw it
 * @param {1 | -1} quarter  clockwise, or anticlockwise
 * @returns {Promise<File>}
 */
export async function turnedFile(file, [width], quarter) {
  const bitmap = await decoded(file);
  // Browsers heed a file's orientation tag, the server does not: what the tag turned lies right.
  const turn = bitmap.width === width ? quarter : 0;
  const size = turn ? [bitmap.height, bitmap.width] : [bitmap.width, bitmap.height];
  const sheet = new OffscreenCanvas(size[0], size[1]);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (sheet.getContext("2d"));
  context.translate(size[0] / 2, size[1] / 2);
  context.rotate((turn * Math.PI) / 2);
  context.imageSmoothingEnabled = false;
  context.drawImage(bitmap, -bitmap.width / 2, -bitmap.height / 2);
  bitmap.close();
  const blob = await sheet.convertToBlob({ type: "image/png" });
  return new File([blob], `${file.name.replace(/\.[^.]*$/, "")}-turned.png`, { type: "image/png" });
}

/** @param {File} file */
async function decoded(file) {
  try {
    return await createImageBitmap(file);
  } catch {
    throw new Error(`This browser cannot open ${file.name}. Turn it by a quarter in a picture program, and choose it anew.`);
  }
}
