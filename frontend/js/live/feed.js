/**
 * Brings a session's frames to the page: those of this device's camera go to the server one at a time, at the rate
 * answers come; those of a stream are asked for, each when the last one was taken.
 *
 * @typedef {import("./liveLogic.js").Shown} Shown
 * @typedef {{onShown: (shown: Shown) => void, onPause: (error: unknown) => void, onEnd: (error: unknown) => void}} FeedEvents
 *   onPause: it is tried again
 */

import { livePicture, newestLiveFrame, readLiveFrame } from "../server/liveApi.js";
import { ApiError, isAbort, isPassing } from "../server/request.js";

const AGAIN_MS = 1000;
// A frame that met another one of the same session, or one that was let go before it was asked for.
const WAIT_MS = 200;

/**
 * @param {() => Promise<Shown | null>} next
 * @param {AbortController} ending
 * @param {FeedEvents} events
 */
async function run(next, { signal }, { onShown, onPause, onEnd }) {
  while (!signal.aborted) {
    try {
      const shown = await next();
      if (shown && !signal.aborted) onShown(shown);
    } catch (error) {
      if (signal.aborted || isAbort(error)) return;
      const isEarly = error instanceof ApiError && (error.code === "busy" || error.code === "frame_not_kept");
      if (isEarly) await wait(WAIT_MS);
      else if (isPassing(error)) {
        onPause(error);
        await wait(AGAIN_MS);
      } else {
        onEnd(error);
        return;
      }
    }
  }
}

/** @param {number} ms */
const wait = (ms) => new Promise((resolve) => window.setTimeout(resolve, ms));

/**
 * @param {string} id
 * @param {import("./browserCamera.js").OpenCamera} camera
 * @param {FeedEvents} events
 * @returns {{stop: () => void}}
 */
export function feedCamera(id, camera, events) {
  const ending = new AbortController();
  const next = async () => {
    await camera.next();
    const picture = await camera.grab();
    return { picture, frame: await readLiveFrame(id, picture, ending.signal) };
  };
  void run(next, ending, events);
  return { stop: () => ending.abort() };
}

/**
 * @param {string} id
 * @param {FeedEvents} events
 * @returns {{stop: () => void}}
 */
export function feedStream(id, events) {
  const ending = new AbortController();
  let last = -1;
  const next = async () => {
    const frame = await newestLiveFrame(id, last, ending.signal);
    if (!frame || frame.number <= last) return null;
    last = frame.number;
    return { frame, picture: await livePicture(id, frame.number, ending.signal) };
  };
  void run(next, ending, events);
  return { stop: () => ending.abort() };
}
