/**
 * Talks to the server about calibrations.
 *
 * @typedef {{name: string, value: number, sigma: number}} Parameter
 *
 * @typedef {object} CalibrationPicture
 * @property {string} name
 * @property {boolean} used
 * @property {"good" | "not_read" | "contradicts" | "rough" | "little"} state
 * @property {string} message
 * @property {number} patches
 * @property {number} rms_px
 * @property {number | null} range_mm
 * @property {number | null} tilt_deg
 *
 * @typedef {object} CalibrationResult
 * @property {number} width
 * @property {number} height
 * @property {"radtan" | "fisheye"} model
 * @property {Parameter[]} intrinsics
 * @property {Parameter[]} distortion
 * @property {number} rms_px
 * @property {(number | null)[][]} sigma_px
 * @property {number[][]} coverage
 * @property {CalibrationPicture[]} pictures
 * @property {{code: string, message: string}[]} findings
 *
 * @typedef {object} Calibration  a job
 * @property {string} id
 * @property {string} name
 * @property {string} pad
 * @property {"queued" | "running" | "done" | "failed" | "cancelled"} state
 * @property {number} steps_done
 * @property {number} steps_total  0 while pictures are read
 * @property {CalibrationResult | null} result
 * @property {{code: string, message: string} | null} error
 */

import { path, request, ROOT } from "./request.js";

/** @param {{pad: string, uploads: string[], lens: string}} wanted @returns {Promise<Calibration>} */
export const startCalibration = (wanted) => request("POST", "/calibrations", { json: wanted });

/** @param {string} id @returns {Promise<Calibration>} */
export const getCalibration = (id) => request("GET", path`/calibrations/${id}`);

/** @param {string} id */
export const deleteCalibration = (id) => request("DELETE", path`/calibrations/${id}`);

/**
 * @param {string} id
 * @param {{name: string | null, readout_ms: number | null}} wanted
 * @returns {Promise<import("./api.js").CameraSummary>}
 */
export const storeCamera = (id, wanted) => request("POST", path`/calibrations/${id}/camera`, { json: wanted });

/** @param {string} id @param {number} number */
export const residualPictureUrl = (id, number) => ROOT + path`/calibrations/${id}/pictures/` + `${number}.webp`;
