/**
 * The table of a flight's frames: which ones, and what it says of each.
 *
 * @typedef {import("../server/flightsApi.js").FrameRecord} FrameRecord
 *
 * @typedef {object} Filter
 * @property {string} status  "", "ok" or "failed"
 * @property {string} reason  empty: any
 * @property {string} layer  empty: any
 * @property {string} quality  "", "full" or "bearing"
 * @property {number | null} from_s
 * @property {number | null} to_s
 * @property {number | null} min_height  mm over the pad
 * @property {number | null} max_height  mm
 *
 * @typedef {{after?: number, before?: number}} Place  empty: the first page
 * @typedef {{items: FrameRecord[], earlier: boolean, later: boolean}} TablePage
 * @typedef {{key: string, frame: number, time: string, outcome: string, kind: string, height: string,
 *   place: string, detail: string, current: boolean}} Row
 */

import { clock, length, number } from "../shared/formatLogic.js";
import { isBearing, rangeInWords } from "../shared/poseLogic.js";
import { reasonInWords } from "../shared/stagesLogic.js";

export const PAGE_FRAMES = 25;
/** What the address says of a table that is open and shows all frames. */
const ALL = "all";
const TEXTS = /** @type {const} */ (["status", "reason", "layer", "quality"]);
const NUMBERS = /** @type {const} */ (["from_s", "to_s", "min_height", "max_height"]);

/** @returns {Filter} that asks for nothing */
export const noFilter = () => ({
  status: "", reason: "", layer: "", quality: "", from_s: null, to_s: null, min_height: null, max_height: null,
});

/** @param {Filter | null} filter  null: the table is closed @returns {string | null} for the address */
export function filterToText(filter) {
  if (!filter) return null;
  const given = [...TEXTS, ...NUMBERS].filter((name) => filter[name] !== null && filter[name] !== "");
  return new URLSearchParams(given.map((name) => [name, String(filter[name])])).toString() || ALL;
}

/** @param {string | null} text  from the address @returns {Filter | null} */
export function filterFromText(text) {
  if (!text) return null;
  const given = new URLSearchParams(text === ALL ? "" : text);
  const filter = noFilter();
  for (const name of TEXTS) filter[name] = given.get(name) ?? "";
  for (const name of NUMBERS) filter[name] = finite(given.get(name));
  return filter;
}

/** @param {string | null} text @returns {number | null} */
function finite(text) {
  const value = text ? Number(text) : NaN;
  return Number.isFinite(value) ? value : null;
}

/** @param {Filter} filter @returns {string} why no frame can fit; empty where one may */
export function filterFault({ from_s: from, to_s: to, min_height: least, max_height: most }) {
  if (from !== null && to !== null && from >= to) return "The time “to” must be after “from”.";
  if (least !== null && most !== null && least > most) return "The height “to” must be above “from”.";
  return "";
}

/**
 * What an answer of the server is in the order of the table.
 * @param {{items: FrameRecord[], next_after: number | null}} answer
 * @param {Place} place
 * @param {number} [most]  that the page may have
 * @returns {TablePage}
 */
export function pageOf({ items, next_after: next }, place, most = PAGE_FRAMES) {
  if (place.before !== undefined) return { items, earlier: items.length === most, later: true };
  return { items, earlier: place.after !== undefined, later: next !== null };
}

/** @param {TablePage} page @param {1 | -1} by @returns {Place} */
export function placeBeside({ items }, by) {
  if (!items.length) return {};
  return by > 0 ? { after: items[items.length - 1].frame } : { before: items[0].frame };
}

/** @param {FrameRecord} record @param {number | null} current @returns {Row} */
export function rowOf(record, current) {
  const { frame, time_s: time } = record;
  const row = { key: String(frame), frame, time: time === null ? "" : clock(time), current: frame === current };
  if (record.status === "ok") {
    const [x, y, z] = record.position_mm ?? [0, 0, 0];
    const { layer = "", cells_read: read, cells_wrong: wrong } = record;
    if (isBearing(record)) {
      return { ...row, outcome: `${layer}, bearing only`, kind: "bearing", height: "", place: "", detail: rangeInWords(record) };
    }
    const cells = read ? `${number(read)} cells read${wrong ? `, ${number(wrong)} wrong` : ""}` : "";
    return { ...row, outcome: layer, kind: layer, height: length(z), place: `${length(x)}, ${length(y)}`, detail: cells };
  }
  const outcome = reasonInWords(record.reason ?? "");
  return { ...row, outcome, kind: "failed", height: "", place: "", detail: record.detail ?? "" };
}
