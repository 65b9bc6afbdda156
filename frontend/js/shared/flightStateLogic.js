/**
 * How far a flight is, in words.
 *
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 */

import { compact, number, percent } from "./formatLogic.js";

/** @type {Record<Flight["state"], string>} */
const STATES = {
  queued: "Waiting",
  running: "Running",
  done: "Done",
  failed: "Failed",
  cancelled: "Cancelled",
};

/** @param {Flight} flight @returns {string} */
export const stateInWords = (flight) => STATES[flight.state] ?? flight.state;

/**
 * How far it is, in one line.
 * @param {Flight} flight
 * @returns {string}
 */
export function progressInWords({ state, frames_done: done, frames_total: total, frames_ok: ok }) {
  if (total === null) return state === "queued" ? "waits for its turn" : "looking into the files";
  const frames = done === total ? number(total) : `${number(done)} of ${number(total)}`;
  const noun = total === 1 ? "frame" : "frames";
  return `${frames} ${noun}${done ? `, ${percent(ok, done)} with a pose` : ""}`;
}

/**
 * How long it will still take; empty where nobody can tell.
 * @param {Flight} flight
 * @param {number} now  ms since 1970
 * @returns {string}
 */
export function restInWords({ state, started_at: started, frames_done: done, frames_total: total }, now) {
  if (state !== "running" || !started || !total || !done) return "";
  const elapsed = now - Date.parse(started);
  if (!(elapsed > 0)) return "";
  const rate = `${compact((1000 * done) / elapsed, 1)} frames/s`;
  const rest = (elapsed * (total - done)) / done;
  const minutes = Math.round(rest / 60_000);
  const left = rest < 60_000 ? `${Math.max(1, Math.round(rest / 1000))} s` : `${minutes} min`;
  return `${rate}, about ${left} left`;
}
