/**
 * Has the server simulate a flight, and looks how far it is until it is over.
 *
 * @typedef {import("./flyLogic.js").Simulation} Simulation
 */

import { isFlying } from "./flyLogic.js";
import * as planApi from "../server/planApi.js";

const EVERY_MS = 700;

/** @param {{onJob: (job: Simulation | null) => void, onFault: (error: unknown) => void}} events */
export function makeFlightSimulator({ onJob, onFault }) {
  /** @type {Simulation | null} */
  let job = null;
  let timer = 0;

  /** @param {Simulation | null} now */
  function show(now) {
    job = now;
    onJob(job);
    window.clearTimeout(timer);
    if (isFlying(job)) timer = window.setTimeout(() => void look(), EVERY_MS);
  }

  /** @param {() => Promise<Simulation>} ask */
  async function attempt(ask) {
    try {
      show(await ask());
    } catch (error) {
      show(null);
      onFault(error);
    }
  }

  async function look() {
    const asked = job;
    if (asked) await attempt(() => planApi.getSimulation(asked.id));
  }

  return {
    /** @param {Record<string, unknown>} spec */
    start: (spec) => attempt(() => planApi.simulateFlight(spec)),
    stop: () =>
      attempt(async () => {
        const asked = /** @type {Simulation} */ (job);
        await planApi.deleteSimulation(asked.id);
        return { ...asked, state: "cancelled" };
      }),
  };
}
