/**
 * Asks the server about live sessions.
 *
 * @typedef {import("./answers.js").PoseRecord} PoseRecord
 * @typedef {import("./tuningApi.js").Marks} Marks
 *
 * @typedef {{median: number, p95: number}} Spread  milliseconds, of the last ten seconds
 *
 * @typedef {object} Figures
 * @property {number} frames  looked at
 * @property {number} read  of these
 * @property {number} dropped
 * @property {number} recent_frames  of the last ten seconds
 * @property {number} recent_read
 * @property {number | null} frames_per_s
 * @property {Spread | null} latency_ms
 * @property {Spread | null} pose_ms
 *
 * @typedef {object} Stream
 * @property {"connecting" | "open" | "lost" | "ended" | "refused"} phase
 * @property {string} detail  why; empty while all is well
 * @property {number} damaged
 * @property {number} connections
 * @property {[number, number] | null} size_px
 * @property {string | null} codec
 *
 * @typedef {object} PrintItem  of the print check
 * @property {string} name
 * @property {"good" | "fair" | "bad" | "unknown"} verdict
 * @property {string} text  what was measured
 * @property {string} advice  what to do; empty where nothing is
 *
 * @typedef {object} Recording
 * @property {string} id
 * @property {boolean} is_on
 * @property {"waiting" | "recording" | "refused" | "stopped" | "closed"} phase
 * @property {string} detail
 * @property {number} frames
 * @property {number} bytes
 *
 * @typedef {object} Session
 * @property {string} id
 * @property {string} source  "browser", or an address
 * @property {{id: string, name: string}} pad
 * @property {{id: string, name: string}} camera
 * @property {"starting" | "running" | "failed" | "idle"} state
 * @property {{code: string, message: string} | null} error
 * @property {Stream | null} stream
 * @property {"found" | "lost" | "no_stream"} sight
 * @property {string} sight_detail
 * @property {number | null} newest
 * @property {Figures | null} figures
 * @property {PrintItem[]} print_check
 * @property {Recording | null} recording  that is under way, or the last one
 *
 * @typedef {object} LiveFrame
 * @property {number} number
 * @property {number} taken_s  since the session began
 * @property {PoseRecord} record
 * @property {Marks} marks
 */

import { watchEvents } from "./eventWatch.js";
import { path, query, request, ROOT, send } from "./request.js";

/** @param {{source: string, pad: string, camera: string}} order @returns {Promise<Session>} */
export const startLive = (order) => request("POST", "/live", { json: order });

/** @returns {Promise<{items: Session[]}>} */
export const listLive = () => request("GET", "/live");

/** @param {string} id @returns {Promise<Session>} */
export const getLive = (id) => request("GET", path`/live/${id}`);

/** @param {string} id @param {boolean} [keepalive]  as the page is left */
export const stopLive = (id, keepalive = false) => request("DELETE", path`/live/${id}`, { keepalive });

/** @param {string} id @returns {Promise<Recording>} */
export const record = (id) => request("POST", path`/live/${id}/recording`);

/** @param {string} id @returns {Promise<Recording>} as it ended */
export const stopRecording = (id) => request("DELETE", path`/live/${id}/recording`);

/** What was recorded as a flight. @param {string} recording @returns {Promise<{id: string}>} */
export const openRecording = (recording) => request("POST", "/flights/from-recording", { json: { recording } });

/**
 * Have a frame of the browser's camera read.
 * @param {string} id @param {Blob} image @param {AbortSignal} signal @returns {Promise<LiveFrame>}
 */
export const readLiveFrame = (id, image, signal) => request("POST", path`/live/${id}/frames`, { form: { image }, signal });

/**
 * The newest frame of a stream; waits for one after a number; null where none has come yet.
 * @param {string} id @param {number} after @param {AbortSignal} signal @returns {Promise<LiveFrame | null>}
 */
export const newestLiveFrame = (id, after, signal) =>
  request("GET", path`/live/${id}/newest` + query({ after }), { signal });

/** @param {string} id @param {number} number @param {AbortSignal} signal @returns {Promise<Blob>} */
export const livePicture = async (id, number, signal) =>
  (await send(ROOT + path`/live/${id}/frames/${number}/picture`, { signal })).blob();

/**
 * Follow a session.
 * @param {string} id
 * @param {{onSession: (session: Session) => void, onFault: (error: unknown) => void}} events
 * @returns {{stop: () => void}}
 */
export const watchLive = (id, { onSession, onFault }) =>
  watchEvents(ROOT + path`/live/${id}/events`, "session", {
    ask: () => getLive(id),
    take: onSession,
    isOver: (session) => session.state === "failed" || session.state === "idle",
    onFault,
  });
