/**
 * Asks the server to read a frame under other parameters.
 *
 * @typedef {object} Parameter
 * @property {string} name  with its group, as `search.least_step`
 * @property {string} group
 * @property {"int" | "float" | "bool"} kind
 * @property {number | boolean} default
 * @property {number} low
 * @property {number} high
 * @property {string | null} not_below  parameter of the group that bounds it, too
 * @property {string | null} not_above
 * @property {string} unit
 * @property {string} text
 * @property {string[]} stages  those that look at it, its own first
 * @property {string[]} methods
 * @property {boolean} followed  it counts only where a video's pose is followed
 *
 * @typedef {[number, number, number, number]} Part  left, top, right, bottom; pixels from the frame's corner
 *
 * @typedef {{trace: string} | {flight: string, frame: number}} Subject
 *
 * @typedef {object} Reading
 * @property {Subject} subject
 * @property {string} [pad]
 * @property {string} [camera]
 * @property {string} method
 * @property {Record<string, Record<string, number | boolean> | number>} params
 *
 * @typedef {object} ViewWish
 * @property {string} stage
 * @property {string | null} channel
 * @property {number} scale
 * @property {Part | null} part
 * @property {boolean} quick
 * @property {boolean} marks
 *
 * @typedef {object} Line
 * @property {[number, number][]} points
 * @property {0 | 1 | null} family
 * @property {"found" | "inserted" | "dropped"} kind
 * @property {number | null} number
 * @property {string} text
 *
 * @typedef {object} Marks  places are frame pixels
 * @property {Line[]} lines
 * @property {[number, number, 0 | 1][]} cells  the flag: it differs from the pad
 * @property {number} cell_px
 * @property {[number, number][][]} outlines
 * @property {[number, number, 0 | 1][]} points  the flag: it counts
 * @property {[number, number][] | null} axes
 *
 * @typedef {object} StageLook
 * @property {string} name
 * @property {import("./answers.js").Channel | null} channel
 * @property {number} elapsed_ms
 * @property {import("./answers.js").Failure | null} failure
 * @property {Part | null} part
 * @property {number | null} pixel
 *
 * @typedef {object} ViewPicture
 * @property {string} stage
 * @property {string | null} channel
 * @property {Part | null} part
 * @property {boolean} exact
 * @property {string | null} media_type
 * @property {string | null} base64
 * @property {Marks | null} marks
 *
 * @typedef {object} Look
 * @property {import("./answers.js").PoseRecord & {source: string}} result
 * @property {{width: number, height: number}} image
 * @property {number} camera_scale
 * @property {StageLook[]} stages
 * @property {ViewPicture[]} pictures
 *
 * @typedef {object} LayerCells  one entry of each column a cell
 * @property {import("./answers.js").Channel} channel
 * @property {number} cell_px
 * @property {number} read
 * @property {number} wrong
 * @property {number} log10_false_alarm
 * @property {number[]} row
 * @property {number[]} column
 * @property {number[]} x
 * @property {number[]} y
 * @property {number[]} expected
 * @property {number[]} level
 * @property {number[]} grey
 * @property {number[][]} thresholds
 * @property {{quarter_turns: number, mirrored: boolean, share: number}[]} fits
 *
 * @typedef {{pose: import("./answers.js").PoseRecord, levels: number, layers: LayerCells[]}} CellsAnswer
 */

import { path, request } from "./request.js";

/** @returns {Promise<Parameter[]>} */
export const listParameters = async () => (await request("GET", "/parameters")).items;

/** @param {Reading} reading */
const bodyOf = ({ subject, ...rest }) => ({ ...subject, ...rest });

/**
 * @param {Reading} reading
 * @param {ViewWish[]} views
 * @param {AbortSignal} signal
 * @returns {Promise<Look>}
 */
export const lookAt = (reading, views, signal) =>
  request("POST", "/looks", { json: { ...bodyOf(reading), views }, signal });

/**
 * @param {Reading} reading
 * @param {{pose?: object, corners?: [number, number][]}} where  neither: the frame's own pose
 * @returns {Promise<CellsAnswer>}
 */
export const compareCells = (reading, where) =>
  request("POST", "/cells", { json: { ...bodyOf(reading), ...where } });

/**
 * The poses of the frames nearest to one that have any.
 * @param {string} flight
 * @param {number} frame
 * @returns {Promise<(import("./answers.js").PoseRecord & {frame: number}) | null>}
 */
export async function nearestPose(flight, frame) {
  const ask = (/** @type {string} */ place) =>
    request("GET", path`/flights/${flight}/frames` + `?status=ok&limit=1&${place}=${frame}`);
  const found = (await Promise.all([ask("before"), ask("after")])).flatMap((page) => page.items);
  const off = (/** @type {{frame: number}} */ item) => Math.abs(item.frame - frame);
  return found.sort((a, b) => off(a) - off(b))[0] ?? null;
}

/**
 * @typedef {object} Sweep
 * @property {string} id
 * @property {string} parameter
 * @property {(number | boolean)[]} values
 * @property {"queued" | "running" | "done" | "failed" | "cancelled"} state
 * @property {number} frames_total
 * @property {number} frames_done
 * @property {string | null} error
 * @property {number[]} won  under each value
 * @property {number[]} lost
 *
 * @param {string} flight
 * @param {{parameter: string, values: (number | boolean)[], failed: number, read: number, method: string,
 *   params: Record<string, any>}} spec
 * @returns {Promise<Sweep>}
 */
export const startSweep = (flight, spec) => request("POST", path`/flights/${flight}/sweeps`, { json: spec });

/** @param {string} id @returns {Promise<Sweep>} */
export const getSweep = (id) => request("GET", path`/sweeps/${id}`);

/** @param {string} id */
export const stopSweep = (id) => request("DELETE", path`/sweeps/${id}`);

/**
 * @typedef {object} Preset
 * @property {string} name
 * @property {string} method
 * @property {Record<string, any>} params
 *
 * @returns {Promise<Preset[]>}
 */
export const listPresets = async () => (await request("GET", "/presets")).items;

/** @param {Preset} preset @returns {Promise<Preset>} */
export const savePreset = ({ name, ...rest }) => request("PUT", path`/presets/${name}`, { json: rest });

/** @param {string} name */
export const deletePreset = (name) => request("DELETE", path`/presets/${name}`);
