/**
 * Whole simulated flights: the form's checks, what the server is asked for, and how far one is.
 *
 * @typedef {import("../server/answers.js").Simulation} Simulation
 *
 * @typedef {Record<string, string>} Texts
 */

import { compact } from "../shared/formatLogic.js";

export const DEFAULT_FLY = Object.freeze({
  flight: "landing",
  frames: "60",
  from_mm: "3000",
  to_mm: "100",
  fps: "30",
  sway: "1",
  look: "clear",
  ground: "grass",
  seed: "1",
});
const RANGES = /** @type {Record<string, [number, number, string]>} */ ({
  frames: [1, 600, "Frames"],
  from_mm: [2, 1_000_000, "Starts at"],
  to_mm: [2, 1_000_000, "Ends at"],
  fps: [0.1, 1000, "Frames a second"],
  sway: [0, 10, "Sway"],
  seed: [0, 2 ** 31, "Seed"],
});
const WHOLE = ["frames", "seed"];
/** Fields that only some flights look at. */
const ONLY = /** @type {Record<string, string[]>} */ ({
  to_mm: ["landing", "gusty", "descent"],
  fps: ["landing", "gusty", "hover"],
  sway: ["landing", "gusty", "hover", "descent"],
});

/** @param {string} name @param {string} flight @returns {boolean} whether a flight looks at a field */
export const isFlown = (name, flight) => ONLY[name]?.includes(flight) ?? true;

/**
 * @param {Texts} texts
 * @returns {{spec: Record<string, string | number> | null, errors: Texts}}  spec: as the server takes
 *   it, without pad and camera
 */
export function parseFly(texts) {
  /** @type {Texts} */
  const errors = {};
  /** @type {Record<string, string | number>} */
  const spec = { flight: texts.flight, look: texts.look, ground: texts.ground };
  for (const [key, [least, most, label]] of Object.entries(RANGES)) {
    if (!isFlown(key, texts.flight)) continue;
    const value = Number(texts[key]);
    const isFine = texts[key].trim() !== "" && value >= least && value <= most;
    if (isFine && (Number.isInteger(value) || !WHOLE.includes(key))) spec[key] = value;
    else errors[key] = `${label}: from ${compact(least)} to ${compact(most)}${WHOLE.includes(key) ? ", whole" : ""}.`;
  }
  return { spec: Object.keys(errors).length ? null : spec, errors };
}

/** @param {Simulation | null} job @returns {boolean} whether it goes on */
export const isFlying = (job) => job?.state === "queued" || job?.state === "running";

/** @param {Simulation | null} job @returns {string} how far it is, for a reader */
export function flyInWords(job) {
  if (!job) return "";
  const { state, frames_done: done, frames_total: total, error } = job;
  if (state === "queued") return "Waits for flights before it.";
  if (state === "running") return `Frame ${Math.min(done + 1, total)} of ${total} …`;
  if (state === "failed") return error ? sentence(error.message) : "Failed.";
  return state === "done" ? `${total} frames are done.` : "Stopped.";
}

/** @param {string} text */
const sentence = (text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;
