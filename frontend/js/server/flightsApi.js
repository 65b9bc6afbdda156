/**
 * Talks to the server about flights and their frames.
 *
 * @typedef {import("./answers.js").PoseRecord} PoseRecord
 * @typedef {import("./answers.js").StageAnswer} StageAnswer
 *
 * @typedef {object} FlightRequest
 * @property {string} pad_id
 * @property {string} pad_name
 * @property {import("./answers.js").KnownPad[]} [pads]
 * @property {string} camera_id
 * @property {string} camera_name
 * @property {string} method
 * @property {Record<string, unknown>} params
 * @property {number} first_frame
 * @property {number | null} end_frame  the first that is not read
 * @property {number} stride
 * @property {string} [version]  of the program that made the run
 * @property {{flight: string, reason: string | null} | null} [only]  read for that run's failed frames alone
 * @property {LiveSession} [live]  its poses are those of a live session
 *
 * @typedef {{program: string, source: string, unix_s: number, is_whole: boolean}} LiveSession
 *
 * @typedef {object} Flight
 * @property {string} id
 * @property {string} name
 * @property {"queued" | "running" | "done" | "failed" | "cancelled"} state
 * @property {string} created_at
 * @property {string | null} started_at
 * @property {string | null} finished_at
 * @property {number | null} frames_total
 * @property {number} frames_done
 * @property {number} frames_ok
 * @property {number} progress  0 … 1
 * @property {{code: string, message: string} | null} error
 * @property {string | null} [notice]  why the work does not go on at present
 * @property {string | null} rerun_of
 * @property {FlightRequest} request
 * @property {{kind: string, name: string, frames: number, first_frame: number,
 *   video?: Record<string, any>}[]} [sources]
 * @property {boolean} [telemetry]
 *
 * @typedef {object} Upload
 * @property {string} id
 * @property {string} name
 * @property {number} size_bytes
 * @property {number} offset
 * @property {boolean} complete
 * @property {string | null} kind  known once it is complete
 *
 * @typedef {PoseRecord & {source: string, frame: number, time_s: number | null}} FrameRecord
 *
 * @typedef {{role: "side" | "x" | "y" | "z", points: [number, number][]}} OutlineLine  shares of the
 *   frame's width and height
 *
 * @typedef {object} Summary
 * @property {number} frames
 * @property {number} ok
 * @property {number | null} share_ok
 * @property {{full: number, bearing: number, unknown: number}} qualities  of the poses
 * @property {{first_frame: number, last_frame: number, frames: number, seconds: number | null} | null} longest_gap
 * @property {Record<string, number>} stages
 * @property {Record<string, number>} reasons
 * @property {Record<string, number>} layers
 * @property {number} damaged
 *
 * @typedef {Partial<Record<"status" | "reason" | "stage" | "layer", string>>
 *   & Partial<Record<"from_s" | "to_s" | "min_height" | "max_height", number | null>>} FrameFilter
 */

import { watchEvents } from "./eventWatch.js";
import { formOf, path, query, request, ROOT, send } from "./request.js";

/** @param {string} id @returns {Promise<Upload>} */
export const getUpload = (id) => request("GET", path`/uploads/${id}`);

/** @param {number} limit @returns {Promise<{items: Flight[], total: number}>} */
export const listFlights = (limit) => request("GET", `/flights${query({ limit })}`);

/** @param {Record<string, unknown>} order @returns {Promise<Flight>} */
export const createFlight = (order) => request("POST", "/flights", { json: order });

/** @param {{uploads: string[], name?: string}} order  the files of a live recording @returns {Promise<Flight>} */
export const openRecording = (order) => request("POST", "/flights/from-recording", { json: order });

/** @param {string} id @returns {Promise<Flight>} */
export const getFlight = (id) => request("GET", path`/flights/${id}`);

/** @param {string} id @returns {Promise<Flight>} */
export const cancelFlight = (id) => request("POST", path`/flights/${id}/cancel`);

/** @param {string} id @returns {Promise<Flight>} */
export const retryFlight = (id) => request("POST", path`/flights/${id}/retry`);

/** @param {string} id @param {Record<string, unknown>} changes @returns {Promise<Flight>} */
export const rerunFlight = (id, changes) => request("POST", path`/flights/${id}/rerun`, { json: changes });

/** @param {string} id */
export const deleteFlight = (id) => request("DELETE", path`/flights/${id}`);

/** @param {string} id @returns {Promise<Summary>} */
export const getSummary = (id) => request("GET", path`/flights/${id}/summary`);

/**
 * Outcomes and heights of a part of a flight, in so many columns.
 * @param {string} id
 * @param {{first_frame?: number, last_frame?: number, columns: number}} part
 * @param {AbortSignal} [signal]
 * @returns {Promise<import("./answers.js").Timeline>}
 */
export const getTimeline = (id, part, signal) =>
  request("GET", path`/flights/${id}/timeline` + query(part), { signal });

/** @param {string} id @returns {Promise<import("./answers.js").Figures>} */
export const getFigures = (id) => request("GET", path`/flights/${id}/figures`);

/** @param {string} id @returns {Promise<import("./answers.js").VehicleComparison>} */
export const getVehicle = (id) => request("GET", path`/flights/${id}/vehicle`);

/**
 * A page of frames, in the order of their numbers.
 * @param {string} id
 * @param {FrameFilter & {after?: number, before?: number, limit: number}} wanted
 * @param {AbortSignal} [signal]
 * @returns {Promise<{items: FrameRecord[], next_after: number | null}>}
 */
export const listFrames = (id, wanted, signal) =>
  request("GET", path`/flights/${id}/frames` + query(wanted), { signal });

/**
 * @typedef {"neither" | "both" | "won" | "lost"} ChangeKind
 *
 * @typedef {object} Comparison  with another run
 * @property {number} frames  that both read
 * @property {number} only_first
 * @property {number} only_second
 * @property {number} won
 * @property {number} lost
 * @property {number} both
 * @property {number} neither
 * @property {{median_mm: number, p95_mm: number, worst_mm: number, worst_share: number | null, worst_frame: number} | null} moved
 * @property {{first_frame: number, last_frame: number, won: number, lost: number, both: number, neither: number,
 *   moved_max_mm: number | null}[]} columns
 *
 * @typedef {object} Change  of one frame
 * @property {number} frame
 * @property {ChangeKind} kind
 * @property {number | null} moved_mm
 * @property {number | null} moved_share
 * @property {number | null} turned_deg
 * @property {FrameRecord} own
 * @property {FrameRecord} other
 *
 * @param {string} id
 * @param {string} other
 * @param {number} columns
 * @returns {Promise<Comparison>}
 */
export const compareFlights = (id, other, columns) =>
  request("GET", path`/flights/${id}/comparison/${other}` + query({ columns }));

/**
 * @param {string} id
 * @param {string} other
 * @param {{kind?: string, least_mm?: number, after?: number, before?: number, limit: number}} wanted
 * @returns {Promise<{items: Change[], next_after: number | null}>}
 */
export const listChanges = (id, other, wanted) =>
  request("GET", path`/flights/${id}/comparison/${other}/frames` + query(wanted));

/**
 * Address of a frame's picture, which takes no reading.
 * @param {string} id
 * @param {number} frame
 * @param {{width?: number, outline?: boolean}} [wanted]  most pixels; the pad drawn over it
 */
export const previewUrl = (id, frame, { width, outline = true } = {}) =>
  ROOT + path`/flights/${id}/frames/${frame}/preview.jpg` + query({ width, outline: outline ? null : "false" });

/**
 * A file of the small pictures of a group of frames; where they lack, their making begins.
 * @param {string} id
 * @param {number} group
 * @returns {Promise<ArrayBuffer>}
 */
export async function getProxies(id, group) {
  return (await send(ROOT + path`/flights/${id}/proxies/${group}`)).arrayBuffer();
}

/**
 * Where the pad lies in frames, from one on.
 * @param {string} id
 * @param {{first_frame: number, limit: number}} wanted
 * @returns {Promise<{items: {frame: number, lines: OutlineLine[]}[]}>}
 */
export const getOutlines = (id, wanted) => request("GET", path`/flights/${id}/outlines` + query(wanted));

/** @param {string} id @param {string} form @param {string} [pad]  its `pad_id`, where one of several is wanted */
export function exportUrl(id, form, pad = "") {
  const url = `${ROOT}${path`/flights/${id}/export`}/${form}`;
  return pad ? `${url}${form.includes("?") ? "&" : "?"}pad_id=${encodeURIComponent(pad)}` : url;
}

/**
 * The export for PX4, which needs the vehicle's own poses.
 * @param {string} id
 * @param {File} vehicle
 * @returns {Promise<Blob>}
 */
export async function exportForPx4(id, vehicle) {
  const response = await send(exportUrl(id, "px4"), { method: "POST", body: formOf({ vehicle }) });
  return response.blob();
}

/**
 * Asks for an export without taking it, so that what the server says against it can be shown.
 * @param {string} url
 * @returns {Promise<void>}  rejected where there is no such file
 */
export async function checkExport(url) {
  const asked = new AbortController();
  await send(url, { signal: asked.signal });
  asked.abort();
}

/** @param {Flight} flight @returns {boolean} true while it may still change */
export const isOpen = ({ state }) => state === "queued" || state === "running";

/**
 * Follow a flight while it runs.
 * @param {string} id
 * @param {(flight: Flight) => void} onFlight
 * @returns {{stop: () => void}}
 */
export const watchFlight = (id, onFlight) =>
  watchEvents(ROOT + path`/flights/${id}/events`, "flight", {
    ask: () => getFlight(id),
    take: onFlight,
    isOver: (flight) => !isOpen(flight),
  });
