/**
 * Fetches a frame's sharp picture as soon as the user rests on it, and tells when the rest is long
 * enough for its stages to be asked for.
 *
 * @typedef {object} Events
 * @property {(frame: number, image: HTMLImageElement) => void} onSharp
 * @property {(frame: number) => void} onRest
 * @property {(frame: number, error: unknown) => void} onFault
 */

import { previewUrl } from "../../server/flightsApi.js";
import { send } from "../../server/request.js";

/** The server is not asked for frames that are only passed. */
const SHARP_MS = 120;
const STAGES_MS = 250;

/**
 * @param {string} id  of the flight
 * @param {Events} events
 */
export function makeFrameLoader(id, { onSharp, onRest, onFault }) {
  /** @type {number | null} */
  let wanted = null;
  let timer = 0;
  let isFetching = false;
  let lastWidth = 0;

  /** The newest frame that is wanted; those passed meanwhile are left out. @param {number} width */
  async function fetchSharp(width) {
    lastWidth = width;
    if (isFetching || wanted === null) return;
    isFetching = true;
    const frame = wanted;
    try {
      const image = await loaded(previewUrl(id, frame, { width, outline: false }));
      if (frame === wanted) onSharp(frame, image);
    } catch (error) {
      if (frame === wanted) onFault(frame, error);
    }
    isFetching = false;
    if (frame !== wanted) void fetchSharp(width);
  }

  return {
    /**
     * Rest on a frame; null: nothing more is wanted.
     * @param {number | null} frame
     * @param {number} [width]  of the sharp picture, pixels
     */
    rest(frame, width = 1280) {
      if (frame === wanted) return;
      wanted = frame;
      window.clearTimeout(timer);
      if (frame === null) return;
      timer = window.setTimeout(() => {
        void fetchSharp(width);
        timer = window.setTimeout(() => onRest(frame), STAGES_MS - SHARP_MS);
      }, SHARP_MS);
    },
    /** Ask once more. */
    again() {
      if (lastWidth) void fetchSharp(lastWidth);
    },
  };
}

/** @param {string} url @returns {Promise<HTMLImageElement>} once it can be drawn */
async function loaded(url) {
  const image = new Image();
  image.src = url;
  try {
    await image.decode();
  } catch (error) {
    // A browser tells of every fault that the image cannot be decoded; the server says which it is.
    await send(url);
    throw error;
  }
  return image;
}
