/**
 * Orders experiments, and looks how far those are that wait or run.
 *
 * @typedef {import("../server/experimentsApi.js").Experiment} Experiment
 * @typedef {import("../server/experimentsApi.js").ExperimentDetail} ExperimentDetail
 */

import * as experimentsApi from "../server/experimentsApi.js";
import { isAtWork } from "./experimentLogic.js";

const EVERY_MS = 1000;

/**
 * @param {{onList: (all: Experiment[]) => void, onFault: (error: unknown) => void}} events
 */
export function makeExperimentWatch({ onList, onFault }) {
  let timer = 0;

  async function look() {
    window.clearTimeout(timer);
    try {
      const { items } = await experimentsApi.listExperiments();
      onList(items);
      if (items.some(isAtWork)) timer = window.setTimeout(() => void look(), EVERY_MS);
    } catch (error) {
      onFault(error);
      // The server may be busy, or be starting again.
      timer = window.setTimeout(() => void look(), 4 * EVERY_MS);
    }
  }

  return {
    look,
    /** @param {Record<string, unknown> & {kind: string}} order @returns {Promise<Experiment>} */
    async start(order) {
      const made = await experimentsApi.startExperiment(order);
      await look();
      return made;
    },
    /** @param {string} id */
    async remove(id) {
      await experimentsApi.deleteExperiment(id);
      await look();
    },
  };
}
