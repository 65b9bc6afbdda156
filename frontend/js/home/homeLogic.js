/**
 * What the first page shows of pads, cameras and flights: one kind of card for all three.
 *
 * @typedef {import("../server/libraryApi.js").Kind} Kind
 * @typedef {import("../server/api.js").PadSummary & {created_at: string}} Pad
 * @typedef {import("../server/api.js").CameraSummary & {created_at: string | null}} Camera
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 *
 * @typedef {object} Card
 * @property {string} key
 * @property {Kind} kind
 * @property {string} id
 * @property {string} name
 * @property {string} href
 * @property {string} note
 * @property {string} date
 * @property {string} createdAt
 * @property {string} state  of a flight, else empty
 * @property {number | null} progress  0 … 1 of one that is at work
 * @property {number | null} [frame]  of a flight that is done: one that it has read
 */

import { progressInWords, stateInWords } from "../shared/flightStateLogic.js";
import { compact, moment, size } from "../shared/formatLogic.js";

/** Cards of a kind that are shown before somebody asks for all. */
export const FEW = 8;

/** @param {Kind} kind @param {{id: string, name: string, created_at: string | null}} item */
const base = (kind, { id, name, created_at: createdAt }) => ({
  key: `${kind}/${id}`, kind, id, name, createdAt: createdAt ?? "",
  date: createdAt ? moment(createdAt) : "", state: "", progress: null,
});

/** @type {{pads: (pad: Pad) => Card, cameras: (camera: Camera) => Card, flights: (flight: Flight) => Card}} */
export const cardOf = {
  pads: (pad) => ({
    ...base("pads", pad), href: `/design?pad=${pad.id}`,
    note: [
      size(...pad.size_mm),
      pad.layers.map((layer) => `${layer.cols} × ${layer.rows}`).join(" and "),
    ].join(" · "),
  }),
  cameras: (camera) => ({
    ...base("cameras", camera), href: `/plan?camera=${camera.id}`,
    note: `${camera.width} × ${camera.height} · ${compact(camera.focal_px, 1)} px · ${camera.model}`,
  }),
  flights: (flight) => {
    const isOpen = flight.state === "queued" || flight.state === "running";
    const words = flight.error?.message ?? flight.notice ?? progressInWords(flight);
    return {
      ...base("flights", flight), href: `/flights/${flight.id}`, state: flight.state,
      note: [stateInWords(flight), words].filter(Boolean).join(" · "),
      progress: isOpen ? flight.progress : null,
      // Which of another run's failed frames a run has read is not told in lists.
      frame: flight.state === "done" && !flight.request.only ? (flight.request.first_frame ?? 0) : null,
    };
  },
};

/**
 * Cards whose texts hold every word of a search.
 * @param {Card[]} cards
 * @param {string} search
 */
export function matching(cards, search) {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const text = (/** @type {Card} */ card) => `${card.name} ${card.note} ${card.date}`.toLowerCase();
  return cards.filter((card) => words.every((word) => text(card).includes(word)));
}

/** @type {Record<string, (a: Card, b: Card) => number>} */
const ORDERS = {
  newest: (a, b) => b.createdAt.localeCompare(a.createdAt),
  oldest: (a, b) => a.createdAt.localeCompare(b.createdAt),
  name: (a, b) => a.name.localeCompare(b.name, undefined, { numeric: true, sensitivity: "base" }),
};

/** @param {Card[]} cards @param {string} order */
export const sorted = (cards, order) => [...cards].sort(ORDERS[order] ?? ORDERS.newest);

/** @param {string} order @returns {string} one that there is */
export const knownOrder = (order) => (Object.hasOwn(ORDERS, order) ? order : "newest");
