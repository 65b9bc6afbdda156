/** Talks to the server about everything that it stores: lists, names, removal, the sample flight. */

import { listCameras, listPads } from "./api.js";
import { listFlights } from "./flightsApi.js";
import { path, request, ROOT } from "./request.js";

/** @typedef {"pads" | "cameras" | "flights"} Kind */

/** @type {Record<Kind, () => Promise<any[]>>} */
export const LISTS = {
  pads: async () => (await listPads()).items,
  cameras: async () => (await listCameras()).stored,
  flights: async () => (await listFlights(200)).items,
};

/** @param {Kind} kind @param {string} id @param {string} name */
export const rename = (kind, id, name) => request("PATCH", `/${kind}` + path`/${id}`, { json: { name } });

/**
 * Sent to its end even while the page closes.
 * @param {Kind} kind
 * @param {string} id
 */
export const remove = (kind, id) => request("DELETE", `/${kind}` + path`/${id}`, { keepalive: true });

/** @param {Kind} kind @param {string} id */
export const thumbnailUrl = (kind, id) => `${ROOT}/${kind}` + path`/${id}/thumbnail.png`;

/** @returns {Promise<import("./flightsApi.js").Flight>} the sample's flight; the same one again */
export const sampleFlight = () => request("POST", "/samples/flight");
