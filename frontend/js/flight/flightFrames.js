/**
 * Fetches the pages of the table of frames.
 *
 * @typedef {import("./frameTableLogic.js").Filter} Filter
 * @typedef {import("./frameTableLogic.js").Place} Place
 */

import { isAbort, messageOf } from "../server/request.js";
import { listFrames } from "../server/flightsApi.js";
import { PAGE_FRAMES, filterFault, pageOf, placeBeside } from "./frameTableLogic.js";

/**
 * @param {string} id  of the flight
 * @param {{state: () => import("./flight.js").State, set: (change: object) => void}} page
 */
export function makeFlightFrames(id, { state, set }) {
  /** @type {Place} */
  let place = {};
  let control = new AbortController();

  /** @param {Place} wanted */
  async function show(wanted) {
    const { filter } = state();
    control.abort();
    if (!filter || filterFault(filter)) return;
    control = new AbortController();
    try {
      const asked = { ...filter, ...wanted, limit: PAGE_FRAMES };
      const answer = await listFrames(id, asked, control.signal);
      // Too few before that frame: the first page has them too.
      if (wanted.before !== undefined && answer.items.length < PAGE_FRAMES) return void show({});
      place = wanted;
      set({ tablePage: pageOf(answer, wanted) });
    } catch (error) {
      if (!isAbort(error)) set({ status: { kind: "bad", text: messageOf(error) } });
    }
  }

  return {
    /** @param {Filter | null} filter  null closes the table */
    filter(filter) {
      set({ filter });
      void show({});
    },
    /** @param {1 | -1} by */
    turn(by) {
      const { tablePage } = state();
      if (tablePage) void show(placeBeside(tablePage, by));
    },
    /** The flight went on. */
    changed() {
      if (!state().tablePage?.later) void show(place);
    },
  };
}
