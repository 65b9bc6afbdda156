/**
 * Fetches the frame that is looked at: its result and a picture at once, its stages as soon as the
 * user rests.
 *
 * @typedef {import("../server/flightsApi.js").FrameRecord} FrameRecord
 * @typedef {import("../server/flightsApi.js").FrameStages} FrameStages
 *
 * @typedef {{width: number, height: number}} Size
 *
 * @typedef {object} Events
 * @property {(frame: number, record: FrameRecord | null) => void} onRecord  null: not read yet
 * @property {(frame: number, url: string, size: Size) => void} onPreview
 * @property {(frame: number, stages: FrameStages, size: Size) => void} onStages
 * @property {(frame: number, error: unknown) => void} onFault
 */

import { isAbort } from "../server/request.js";
import { hasPicture } from "./flightFrameLogic.js";
import { getStages, listFrames, previewUrl } from "../server/flightsApi.js";

/** Stages take the server a while: it is not asked for frames that are only passed. */
const REST_MS = 400;

/**
 * @param {string} id  of the flight
 * @param {Events} events
 */
export function makeFrameLoader(id, { onRecord, onPreview, onStages, onFault }) {
  /** @type {number | null} */
  let wanted = null;
  /** @type {number | null}  that there is something to see of */
  let seen = null;
  let control = new AbortController();
  let timer = 0;
  let busy = false;
  let previewing = false;

  /** @param {number} frame */
  async function fetchRecord(frame) {
    control.abort();
    control = new AbortController();
    try {
      const { items } = await listFrames(id, { after: frame - 1, limit: 1 }, control.signal);
      const record = items[0]?.frame === frame ? items[0] : null;
      if (frame !== wanted) return;
      onRecord(frame, record);
      seen = record && hasPicture(record) ? frame : null;
      void fetchPreview();
    } catch (error) {
      if (!isAbort(error) && frame === wanted) onFault(frame, error);
    }
  }

  /** The newest frame that is wanted; those passed meanwhile are left out. */
  async function fetchPreview() {
    if (previewing || seen === null || seen !== wanted) return;
    previewing = true;
    const frame = wanted;
    const url = previewUrl(id, frame);
    try {
      const size = await sizeOf(url);
      if (frame === wanted) onPreview(frame, url, size);
    } catch (error) {
      if (frame === wanted) onFault(frame, error);
    }
    previewing = false;
    if (frame !== wanted) void fetchPreview();
    else timer = window.setTimeout(() => void fetchStages(), REST_MS);
  }

  /** One at a time: what the server has begun it ends, and a queue of it would make all wait. */
  async function fetchStages() {
    if (busy || seen === null || seen !== wanted) return;
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
    /** Have a frame's picture ready. @param {number} frame */
    prepare(frame) {
      new Image().src = previewUrl(id, frame);
    },
  };
}

/**
 * A picture's size; it is shown only when it is there, so that frames follow without a flash.
 * @param {string} url
 * @returns {Promise<Size>}
 */
async function sizeOf(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  return { width: image.naturalWidth, height: image.naturalHeight };
}
