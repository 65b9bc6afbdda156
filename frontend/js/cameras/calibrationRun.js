/**
 * Sends the pictures of a calibration, has it made, and looks how far it is.
 *
 * @typedef {import("../server/calibrationApi.js").Calibration} Calibration
 *
 * @typedef {object} PictureFile
 * @property {string} key
 * @property {File} file
 * @property {number} share  sent of it, 0 … 1
 * @property {string} upload  id, once it is sent
 * @property {string | null} url  of the upload
 * @property {string} note  what is wrong
 */

import * as calibrationApi from "../server/calibrationApi.js";
import { ApiError, isAbort, messageOf } from "../server/request.js";
import { removeUpload, sendFile } from "../server/uploads/tusUpload.js";
import { isAtWork } from "./calibrationLogic.js";

const EVERY_MS = 500;

/**
 * @param {{onFiles: (files: PictureFile[]) => void, onJob: (job: Calibration | null) => void,
 *   onFault: (error: unknown) => void}} events
 */
export function makeCalibrationRun({ onFiles, onJob, onFault }) {
  /** @type {PictureFile[]} */
  let files = [];
  /** @type {Calibration | null} */
  let job = null;
  let timer = 0;
  let count = 0;
  let sending = new AbortController();

  /** @param {PictureFile[]} next */
  function set(next) {
    files = next;
    onFiles(files);
  }
  const change = (/** @type {string} */ key, /** @type {Partial<PictureFile>} */ values) =>
    set(files.map((each) => (each.key === key ? { ...each, ...values } : each)));

  /** @param {Calibration | null} now */
  function show(now) {
    job = now;
    onJob(job);
    window.clearTimeout(timer);
    if (isAtWork(job)) timer = window.setTimeout(() => void look(), EVERY_MS);
  }

  async function look() {
    const asked = job;
    if (!asked) return;
    try {
      const now = await calibrationApi.getCalibration(asked.id);
      // It may have been stopped meanwhile.
      if (job?.id === asked.id) show(now);
    } catch (error) {
      if (job?.id !== asked.id) return;
      // The server may be busy, or be starting again; only what it says for good ends the wait.
      if (error instanceof ApiError && error.status === 404) {
        show(null);
        onFault(error);
      } else timer = window.setTimeout(() => void look(), 4 * EVERY_MS);
    }
  }

  /** @param {string} key */
  async function send(key) {
    const { file, url } = /** @type {PictureFile} */ (files.find((each) => each.key === key));
    const upload = await sendFile(file, {
      url,
      signal: sending.signal,
      onProgress: ({ url: place, offset, trouble }) => change(key, {
        ...(place === undefined ? {} : { url: place }),
        ...(offset === undefined ? {} : { share: file.size ? offset / file.size : 1 }),
        ...(trouble === undefined ? {} : { note: trouble ? messageOf(trouble) : "" }),
      }),
    });
    change(key, { upload, share: 1, note: "" });
  }

  return {
    /** @param {File[]} chosen */
    add(chosen) {
      set([...files, ...chosen.map((file) => ({ key: `${(count += 1)}`, file, share: 0, upload: "", url: null, note: "" }))]);
    },
    /** @param {(file: PictureFile) => boolean} isGone */
    remove(isGone) {
      for (const { url } of files.filter(isGone)) if (url) void removeUpload(url);
      set(files.filter((each) => !isGone(each)));
    },
    /** @param {{pad: string, lens: string}} order */
    async start(order) {
      const { signal } = (sending = new AbortController());
      try {
        for (const { key, upload } of [...files]) {
          if (upload) continue;
          try {
            await send(key);
          } catch (error) {
            if (!isAbort(error)) change(key, { note: messageOf(error) });
            throw error;
          }
        }
        const uploads = files.map((each) => each.upload);
        const made = await calibrationApi.startCalibration({ ...order, uploads });
        if (signal.aborted) await calibrationApi.deleteCalibration(made.id);
        else show(made);
      } catch (error) {
        if (!isAbort(error)) onFault(error);
      }
    },
    async stop() {
      sending.abort();
      const asked = job;
      show(null);
      if (!asked) return;
      try {
        await calibrationApi.deleteCalibration(asked.id);
      } catch (error) {
        onFault(error);
      }
    },
    /** Show a calibration that was made before. @param {string} id */
    async open(id) {
      try {
        show(await calibrationApi.getCalibration(id));
      } catch {
        // It went with the server that made it; a camera that was stored is in the list.
        show(null);
      }
    },
  };
}
