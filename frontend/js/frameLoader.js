/**
 * Fetches the frame that is looked at: its result at once, its stages as soon as the user rests.
 *
 * @typedef {import("./flightsApi.js").FrameRecord} FrameRecord
 * @typedef {import("./flightsApi.js").FrameStages} FrameStages
 *
 * @typedef {object} Events
 * @property {(frame: number, record: FrameRecord | null) => void} onRecord  null: not read yet
 * @property {(frame: number, stages: FrameStages, size: {width: number, height: number}) => void} onStages
 * @property {(frame: number, error: unknown) => void} onFault
 */

import { isAbort } from "./api.js";
import { getStages, listFrames } from "./flightsApi.js";

/** Stages take the server a while: it is not asked for frames that are only passed. */
const REST_MS = 120;

/**
 * @param {string} id  of the flight
 * @param {Events} events
 */
export function makeFrameLoader(id, { onRecord, onStages, onFault }) {
  /** @type {number | null} */
  let wanted = null;
  let control = new AbortController();
  let timer = 0;
  let busy = false;

  /** @param {number} frame */
  async function fetchRecord(frame) {
    control.abort();
    control = new AbortController();
    try {
      const { items } = await listFrames(id, { after: frame - 1, limit: 1 }, control.signal);
      const record = items[0]?.frame === frame ? items[0] : null;
      if (frame !== wanted) return;
      onRecord(frame, record);
      window.clearTimeout(timer);
      if (record) timer = window.setTimeout(() => void fetchStages(), REST_MS);
    } catch (error) {
      if (!isAbort(error) && frame === wanted) onFault(frame, error);
    }
  }

  /** One at a time: what the server has begun it ends, and a queue of it would make all wait. */
  async function fetchStages() {
    if (busy || wanted === null) return;
    busy = true;
    const frame = wanted;
    try {
      const stages = await getStages(id, frame);
      const size = await sizeOf(stages.result_picture);
      if (frame === wanted) onStages(frame, stages, size);
    } catch (error) {
      if (frame === wanted) onFault(frame, error);
    }
    busy = false;
    if (frame !== wanted) void fetchStages();
  }

  return {
    /** @param {number} frame */
    want(frame) {
      if (frame === wanted) return;
      wanted = frame;
      window.clearTimeout(timer);
      void fetchRecord(frame);
    },
    /** Look again, because the flight went on. */
    again() {
      if (wanted !== null && !busy) void fetchRecord(wanted);
    },
    /** Have the server prepare a frame. @param {number} frame */
    async prepare(frame) {
      await getStages(id, frame).catch(() => null);
    },
  };
}

/**
 * A picture's size; it is shown only when it is there, so that frames follow without a flash.
 * @param {string} url
 * @returns {Promise<{width: number, height: number}>}
 */
async function sizeOf(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  return { width: image.naturalWidth, height: image.naturalHeight };
}
