/**
 * Fetches what the charts of a flight show, no more often than anybody can see.
 *
 * @typedef {import("./timelineLogic.js").Timeline} Timeline
 */

import { getPad } from "../server/api.js";
import { isAbort } from "../server/request.js";
import { getFigures, getFlight, getSummary, getTimeline, getVehicle, isOpen, listFlights } from "../server/flightsApi.js";
import { loadFault } from "../shared/components/status.js";
import { wholeOf } from "./timelineLogic.js";

const BUSY_MS = 1000;
const ZOOM_MS = 60;
const COARSE = 120;
const RUNS = 200;

/**
 * @param {string} id
 * @param {{state: () => import("./flight.js").State, set: (change: object) => void,
 *   columns: () => number}} page
 */
export function makeFlightData(id, { state, set, columns }) {
  let chartsWanted = false;
  let changeTimer = 0;
  let zoomTimer = 0;
  let control = new AbortController();

  /** @param {unknown} error */
  function complain(error) {
    if (!isAbort(error)) set({ status: loadFault(error) });
  }

  /** The part that is shown, of this run or another, in the same columns. */
  function wanted() {
    const { flight, part } = state();
    const shown = part ?? (flight ? wholeOf(flight) : null);
    return { columns: columns(), ...(shown ? { first_frame: shown.first, last_frame: shown.last } : {}) };
  }

  async function timeline() {
    control.abort();
    control = new AbortController();
    const { signal } = control;
    const { compared } = state();
    try {
      const [own, other] = await Promise.all([
        getTimeline(id, wanted(), signal),
        compared ? getTimeline(compared, wanted(), signal) : null,
      ]);
      set({ timeline: own, otherTimeline: other });
    } catch (error) {
      complain(error);
    }
  }

  async function refreshCharts() {
    if (!chartsWanted) return;
    const part = { ...wanted(), columns: COARSE };
    const [figures, coarse] = await Promise.all([getFigures(id), getTimeline(id, part)]);
    set({ figures, coarse });
    const { flight, vehicle } = state();
    // Of a whole flight, once: it takes a second, and no part of the flight tells as much.
    if (flight?.telemetry && !isOpen(flight) && !vehicle) set({ vehicle: await getVehicle(id).catch(() => null) });
  }

  async function pad() {
    const wanted = state().flight?.request.pad_id;
    if (!wanted) return;
    // The pad may be gone since; the flight keeps a copy, but the chart does without.
    const found = await getPad(wanted).catch(() => null);
    if (found) set({ pad: { size: found.size_mm, file: found.pad } });
  }

  async function all() {
    changeTimer = 0;
    try {
      const [summary] = await Promise.all([getSummary(id), timeline(), refreshCharts()]);
      set({ summary });
    } catch (error) {
      complain(error);
    }
  }

  return {
    /** The flight went on. */
    changed() {
      const { flight, timeline: known } = state();
      const wait = known && flight && isOpen(flight) ? BUSY_MS : 0;
      changeTimer ||= window.setTimeout(() => void all(), wait);
    },
    timelineSoon() {
      window.clearTimeout(zoomTimer);
      zoomTimer = window.setTimeout(() => void timeline(), ZOOM_MS);
    },
    /** The charts came into view. */
    async figures() {
      if (chartsWanted) return;
      chartsWanted = true;
      try {
        await Promise.all([pad(), refreshCharts(), this.other()]);
      } catch (error) {
        complain(error);
      }
    },
    /** The second run, where one is compared. */
    async other() {
      const { compared } = state();
      await timeline();
      if (!compared || !chartsWanted) return;
      try {
        const [otherFigures, otherCoarse] = await Promise.all([
          getFigures(compared),
          getTimeline(compared, { ...wanted(), columns: COARSE }),
        ]);
        if (compared === state().compared) set({ otherFigures, otherCoarse });
      } catch (error) {
        complain(error);
      }
    },
    /** Other runs of the same footage. */
    async runs() {
      const { flight } = state();
      if (!flight) return;
      const root = flight.rerun_of ?? id;
      const { items } = await listFlights(RUNS);
      const runs = items.filter((each) => each.id !== id && (each.id === root || each.rerun_of === root || each.rerun_of === id));
      if (flight.rerun_of && !runs.some((run) => run.id === root)) {
        runs.push(...(await getFlight(root).then((run) => [run], () => [])));
      }
      const { compared } = state();
      const isKnown = runs.some((run) => run.id === compared);
      set({ runs, ...(compared && !isKnown ? { compared: null } : {}) });
    },
  };
}
