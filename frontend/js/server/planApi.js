/**
 * Talks to the server about what comes before a flight: bounds, proofs, sheets, coverage, frames.
 *
 * @typedef {import("./answers.js").PadShape} PadShape
 * @typedef {import("./answers.js").SheetPlan} SheetPlan
 * @typedef {import("./answers.js").CoverageChart} CoverageChart
 *
 * @typedef {object} PadBounds  counts as powers of ten
 * @property {number} windows_needed
 * @property {number | null} log10_possible
 * @property {number | null} log10_at_most
 * @property {number | null} share
 * @property {number} largest_square
 * @property {"easy" | "long" | "impossible"} outlook
 *
 * @typedef {object} Crosstalk
 * @property {number[][]} matrix
 * @property {number} red_separation
 * @property {number} blue_separation
 * @property {string[]} warnings
 *
 * @typedef {object} SuccessMap
 * @property {"tilt_deg" | "blur_px"} axis
 * @property {number[]} heights_mm
 * @property {number[]} values
 * @property {number[][]} success
 * @property {number[][]} wrong
 * @property {number} trials
 *
 * @typedef {object} Advice
 * @property {number} window
 * @property {number} levels
 * @property {number} cell_mm
 * @property {number} ratio
 * @property {number} cells
 * @property {number} size_mm
 * @property {number} low_mm
 * @property {number} high_mm
 * @property {string[]} notes
 *
 * @typedef {object} SimulatedFrame
 * @property {{media_type: string, base64: string}} picture
 * @property {number} width
 * @property {number} height
 * @property {{position_mm: number[], rotation: number[][], heading_deg: number,
 *   tilt_deg: number}} truth
 */

import { path, query, request, ROOT } from "./request.js";

/**
 * @param {import("./answers.js").PadSpec} spec
 * @param {AbortSignal} signal
 * @returns {Promise<PadBounds>}
 */
export const padBounds = (spec, signal) => request("POST", "/pads/bounds", { json: spec, signal });

/**
 * @param {string} id
 * @param {AbortSignal} signal
 * @returns {Promise<{verification: import("./answers.js").Verification}>}
 */
export const verifyPad = (id, signal) => request("GET", path`/pads/${id}/verification`, { signal });

/**
 * @param {PadShape} pad
 * @param {Record<string, string | number>} options
 * @param {AbortSignal} signal
 * @returns {Promise<SheetPlan>}
 */
export const planSheets = (pad, options, signal) =>
  request("POST", "/sheets", { json: { pad, options }, signal });

/**
 * @param {string} id
 * @param {{x_mm: number, y_mm: number, ruler_mm: number}} readings
 * @returns {Promise<import("./api.js").PadSummary>}
 */
export const setScale = (id, readings) =>
  request("PUT", path`/pads/${id}/scale`, { json: readings });

/** @param {string} id @param {File} image @returns {Promise<Crosstalk & {kept: boolean}>} */
export const measureCrosstalk = (id, image) =>
  request("POST", path`/pads/${id}/crosstalk`, { form: { image } });

/** @param {string} id @returns {Promise<import("./api.js").PadSummary>} */
export const forgetCrosstalk = (id) => request("DELETE", path`/pads/${id}/crosstalk`);

/**
 * @param {PadShape} pad
 * @param {string} camera
 * @param {number[]} tilts
 * @param {AbortSignal} signal
 * @returns {Promise<CoverageChart>}
 */
export const planCoverage = (pad, camera, tilts, signal) =>
  request("POST", "/coverage", { json: { pad, camera, tilts_deg: tilts }, signal });

/**
 * @param {string} id
 * @param {string} camera
 * @param {number[]} tilts
 * @param {AbortSignal} signal
 * @returns {Promise<CoverageChart>}
 */
export function getCoverage(id, camera, tilts, signal) {
  const wanted = new URLSearchParams([
    ["camera", camera], ...tilts.map((tilt) => ["tilt_deg", String(tilt)]),
  ]);
  return request("GET", `${path`/pads/${id}/coverage`}?${wanted}`, { signal });
}

/**
 * @param {string} id
 * @param {{camera: string, method: string, axis: string, heights_mm: number[], values: number[],
 *   trials: number, seed: number}} wish
 * @param {AbortSignal} signal
 * @returns {Promise<SuccessMap>}
 */
export const simulateCoverage = (id, wish, signal) =>
  request("POST", path`/pads/${id}/coverage`, { json: wish, signal });

/**
 * @param {Record<string, string>} wish
 * @param {AbortSignal} signal
 * @returns {Promise<Advice>}
 */
export const getAdvice = (wish, signal) =>
  request("GET", `/advice${query(wish)}`, { signal });

/**
 * @param {Record<string, unknown>} spec
 * @param {AbortSignal} [signal]
 * @returns {Promise<SimulatedFrame>}
 */
export const simulateFrame = (spec, signal) =>
  request("POST", "/simulate", { json: spec, signal });

/** @param {Record<string, unknown>} spec @returns {Promise<import("./answers.js").Simulation>} */
export const simulateFlight = (spec) => request("POST", "/simulations", { json: spec });

/** @param {string} id @returns {Promise<import("./answers.js").Simulation>} */
export const getSimulation = (id) => request("GET", path`/simulations/${id}`);

/** @param {string} id @returns {Promise<null>} */
export const deleteSimulation = (id) => request("DELETE", path`/simulations/${id}`);

/** @param {string} id @returns {string} address of pictures and truth */
export const simulationFileUrl = (id) => ROOT + path`/simulations/${id}/files/flight.zip`;

/** @returns {Promise<{items: {name: string, note: string}[], grounds: string[]}>} */
export const listLooks = () => request("GET", "/simulate/looks");
