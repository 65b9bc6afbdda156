/**
 * Compares the cells with the pad: with the frame's own pose, corners that are clicked, or the
 * nearest frame's pose carried over.
 *
 * @typedef {"own" | "corners" | "neighbour"} From
 *
 * @typedef {object} Comparison
 * @property {From | null} from
 * @property {[number, number][]} corners  frame pixels
 * @property {import("../../server/tuningApi.js").CellsAnswer | null} cells
 * @property {string} layer  that is shown
 * @property {number | null} carried  the frame whose pose it is, of `neighbour`
 * @property {string} cellsFault
 */

import { compareCells, nearestPose } from "../../server/tuningApi.js";
import { messageOf } from "../../server/request.js";
import { cornersFromText, cornersToText } from "./workbenchLogic.js";

/** @type {Readonly<Omit<Comparison, "layer">>} */
export const NO_COMPARISON = Object.freeze({ from: null, corners: [], cells: null, carried: null, cellsFault: "" });

/**
 * What of a comparison an address holds.
 * @param {URLSearchParams} query
 * @returns {Pick<Comparison, "from" | "corners">}
 */
export function comparisonFrom(query) {
  const corners = cornersFromText(query.get("corners"));
  const text = query.get("cells");
  const from = text === "own" || text === "corners" || text === "neighbour" ? text : null;
  return from === "corners" ? { from, corners } : { from, corners: [] };
}

/** @param {Comparison} comparison @returns {Record<string, string | null>} for the address */
export const comparisonToAddress = ({ from, corners }) => ({ cells: from, corners: cornersToText(corners) });

/**
 * @param {object} options
 * @param {() => Comparison} options.state
 * @param {() => import("../../server/tuningApi.js").Reading | null} options.reading
 * @param {(change: Partial<Comparison>) => void} options.set
 */
export function makeComparison({ state, reading, set }) {
  let turn = 0;

  /** @param {From} from @param {import("../../server/tuningApi.js").Subject} subject */
  async function placeFor(from, subject) {
    if (from === "corners") return { place: { corners: state().corners }, carried: null };
    if (from === "own" || !("flight" in subject)) return { place: {}, carried: null };
    const pose = await nearestPose(subject.flight, subject.frame);
    if (!pose) throw new Error("No other frame of this flight has a pose to carry over.");
    const { position_mm, quaternion_xyzw, frame: carried } = pose;
    return { place: { pose: { position_mm, quaternion_xyzw } }, carried };
  }

  /** Ask again, under the parameters as they are; the newest answer counts. */
  async function ask() {
    const { from, corners } = state();
    const asked = reading();
    if (!from || !asked || (from === "corners" && corners.length < 4)) return;
    const mine = (turn += 1);
    try {
      const { place, carried } = await placeFor(from, asked.subject);
      const cells = await compareCells(asked, place);
      if (mine !== turn) return;
      const { layer } = state();
      const channels = cells.layers.map(({ channel }) => channel);
      const shown = channels.find((channel) => channel === layer) ?? channels[0] ?? layer;
      set({ cells, carried, layer: shown, cellsFault: channels.length ? "" : "No cell can be read with this pose: the pad would lie outside the picture, or the picture is flat there." });
    } catch (error) {
      if (mine === turn) set({ cells: null, cellsFault: messageOf(error) });
    }
  }

  return {
    ask,
    /** @param {From | null} from  null ends it */
    choose(from) {
      turn += 1;
      set({ ...NO_COMPARISON, from });
      void ask();
    },
    /** @param {{x: number, y: number}} at  pixels from the frame's corner */
    click({ x, y }) {
      const { from, corners } = state();
      if (from !== "corners" || corners.length >= 4) return;
      set({ corners: [...corners, [x - 0.5, y - 0.5]] });
      void ask();
    },
  };
}
