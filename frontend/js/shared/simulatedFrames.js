/**
 * Pictures that the server simulates, as files.
 *
 * @typedef {import("./frameLogic.js").FrameWish} FrameWish
 * @typedef {import("../server/planApi.js").SimulatedFrame} SimulatedFrame
 */

import { frameName } from "./frameLogic.js";
import { simulateFrame } from "../server/planApi.js";

/**
 * A simulated picture as a file.
 * @param {SimulatedFrame} frame
 * @param {string} name
 * @returns {File}
 */
function fileOfFrame({ picture }, name) {
  const bytes = Uint8Array.from(atob(picture.base64), (letter) => letter.charCodeAt(0));
  return new File([bytes], name, { type: picture.media_type });
}

/**
 * @param {FrameWish[]} wishes
 * @param {{pad: string, camera: string}} reading
 * @param {AbortSignal} [signal]
 * @returns {AsyncGenerator<{file: File, truth: SimulatedFrame["truth"]}>}
 */
export async function* simulateFrames(wishes, reading, signal) {
  for (const wish of wishes) {
    const frame = await simulateFrame({ ...reading, ...wish }, signal);
    yield { file: fileOfFrame(frame, frameName(wish)), truth: frame.truth };
  }
}
