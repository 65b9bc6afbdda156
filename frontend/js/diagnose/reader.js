/**
 * Sends waiting pictures to the detector, one after the other.
 *
 * @typedef {import("../shared/queueLogic.js").Frame} Frame
 *
 * @typedef {import("../shared/readingChoice.js").ReadingChoice & {atRest: boolean}} Job
 *
 * @typedef {object} ReaderOptions
 * @property {() => Frame | null} next  the picture to read next
 * @property {() => Job} job  how it is read
 * @property {(id: string, values: Partial<Frame>) => void} change
 */

import * as api from "../server/api.js";
import { isAbort, isPassing, messageOf } from "../server/request.js";
import { turnedSize } from "./turning.js";
import { padIds } from "../shared/readingLogic.js";

/**
 * @param {ReaderOptions} options
 */
export function makeReader({ next, job, change }) {
  /** @type {AbortController | null} */
  let running = null;

  /** @param {Frame} frame @param {File} image @param {AbortSignal} signal */
  async function read({ id }, image, signal) {
    change(id, { status: "running" });
    try {
      const { camera, method, atRest } = job();
      const answer = await api.detect({ image, pads: padIds(job()), camera, method, atRest }, signal);
      if (!signal.aborted) change(id, { status: answer.result.status, answer });
    } catch (error) {
      // A picture that was stopped waits again under its new terms, or is gone.
      if (isAbort(error)) return;
      change(id, { status: "refused", message: messageOf(error), turned: turnedSize(error), passing: isPassing(error) });
    }
  }

  return {
    /** Stop the picture under way. */
    abort() {
      running?.abort();
    },
    /** Read until no picture waits; a second call while the first runs does nothing. */
    async work() {
      if (running) return;
      for (;;) {
        const { pad, camera } = job();
        const frame = pad && camera ? next() : null;
        if (!frame?.file) break;
        running = new AbortController();
        await read(frame, frame.file, running.signal);
      }
      running = null;
    },
  };
}
