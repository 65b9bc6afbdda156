/**
 * Asks the server about pads, cameras and pictures.
 *
 * @typedef {import("./answers.js").PadSpec} PadSpec
 * @typedef {import("./answers.js").PadFile} PadFile
 *
 * @typedef {object} PadSummary
 * @property {string} id
 * @property {string} name
 * @property {number} window
 * @property {number} levels
 * @property {[number, number]} size_mm
 * @property {{channel: string, rows: number, cols: number, cell_mm: number}[]} layers
 * @property {number | null} seed
 * @property {string | null} method
 * @property {"rotation" | "plain" | null} unique
 * @property {number | null} distance
 * @property {[number, number]} scale  measured size of the print over its nominal size
 * @property {import("./planApi.js").Crosstalk | null} crosstalk  by which frames are un-mixed
 * @property {string} created_at
 *
 * @typedef {object} CameraSummary
 * @property {string} id
 * @property {string} name
 * @property {number} width
 * @property {number} height
 * @property {number} focal_px
 * @property {string} model
 * @property {number[]} distortion
 * @property {boolean} nominal
 * @property {number | null} [readout_ms]  first row to last; 0 is a global shutter
 * @property {string} [note]
 */

import { path, request, ROOT } from "./request.js";

// Pads

/**
 * @param {PadSpec} spec
 * @param {AbortSignal} signal
 * @returns {Promise<{pad: PadFile, verification: import("./answers.js").Verification}>}
 */
export const previewPad = (spec, signal) =>
  request("POST", "/pads/preview", { json: spec, signal });

/** @param {PadSpec} spec @returns {Promise<PadSummary>} */
export const createPad = (spec) => request("POST", "/pads", { json: spec });

/**
 * Import a pad file, or a table or picture of a field with what it does not say itself.
 * @param {File} file
 * @param {Record<string, string>} [sizes]
 * @returns {Promise<PadSummary>}
 */
export const importPad = (file, sizes = {}) =>
  request("POST", "/pads/import", { form: { ...sizes, file } });

/** @returns {Promise<{items: PadSummary[], total: number}>} */
export const listPads = () => request("GET", "/pads?limit=1000");

/** @param {string} id @returns {Promise<PadSummary & {pad: PadFile}>} */
export const getPad = (id) => request("GET", path`/pads/${id}`);

/** @param {string} id */
export const deletePad = (id) => request("DELETE", path`/pads/${id}`);

/**
 * Address of a pad in a file's form.
 * @param {string} id
 * @param {string} form
 * @param {string} [query]  how it is printed
 * @returns {string}
 */
export const padFileUrl = (id, form, query = "") =>
  ROOT + path`/pads/${id}/files/pad.${form}` + query;

// Cameras

/** @returns {Promise<{presets: CameraSummary[], stored: CameraSummary[]}>} */
export async function listCameras() {
  const [presets, stored] = await Promise.all([
    request("GET", "/cameras/presets"),
    request("GET", "/cameras"),
  ]);
  return { presets: presets.items, stored: stored.items };
}

/**
 * @typedef {object} CameraImport
 * @property {boolean} noDistortion  the lens has none, and the file is silent of it
 * @property {string} which  of a file of several cameras, the one; empty where there is one
 *
 * @param {File} file @param {CameraImport} [said] @returns {Promise<CameraSummary>}
 */
export const importCamera = (file, { noDistortion = false, which = "" } = { noDistortion: false, which: "" }) =>
  request("POST", "/cameras", { form: { file, no_distortion: String(noDistortion), camera: which } });

/** Forms in which cameras are saved, and their files. @type {Record<string, string>} */
export const CAMERA_FORMS = {
  ROS: "camera.yaml",
  OpenCV: "opencv.yaml",
  Kalibr: "kalibr.yaml",
  COLMAP: "cameras.txt",
};

/** @param {string} id @param {string} file  of `CAMERA_FORMS` */
export const cameraFileUrl = (id, file) => ROOT + path`/cameras/${id}/files/${file}`;

/**
 * Say how long a camera's shutter rolls; a preset stays as it is, and a copy is stored.
 * @param {string} id
 * @param {number | null} readoutMs
 * @returns {Promise<CameraSummary>}
 */
export const setReadout = (id, readoutMs) =>
  request("PUT", path`/cameras/${id}/readout`, { json: { readout_ms: readoutMs } });

// The tour's sample

/**
 * @typedef {{pad: string, camera: string, pictures: string[]}} Sample  addresses of files
 *
 * @returns {Promise<Sample>}
 */
export const getSample = () => request("GET", "/samples");

// Detection

/**
 * @typedef {import("./answers.js").DetectAnswer} DetectAnswer
 *
 * @param {{image: File, pads: string[], camera: string, method: string, atRest: boolean}} job
 * @param {AbortSignal} signal
 * @returns {Promise<DetectAnswer>}
 */
export function detect({ image, pads, camera, method, atRest }, signal) {
  const form = { image, pad: pads, camera, method, at_rest: String(atRest), trace: "true", paint: "false" };
  return request("POST", "/detect", { form, signal });
}

/** @param {string} traceId @returns {Promise<DetectAnswer>} */
export const getDetection = (traceId) =>
  request("GET", path`/detect/${traceId}`);
