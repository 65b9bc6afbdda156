/**
 * Asks the server for bundles: a frame with all that its result rests on, in one zip.
 *
 * @typedef {import("./answers.js").PoseRecord} PoseRecord
 * @typedef {{field: string, then: unknown, now: unknown}} Difference
 *
 * @typedef {object} Bundle  what a bundle says, and what is otherwise here
 * @property {"still" | "run"} reading
 * @property {string} method
 * @property {Record<string, any>} params
 * @property {Record<string, string>} view
 * @property {string} pad
 * @property {string[]} others
 * @property {string} camera
 * @property {boolean} same
 * @property {Difference[]} differences
 * @property {Difference[]} recorded_differences
 * @property {Difference[]} alone_differences
 * @property {{name: string, then: string | null, now: string | null}[]} versions
 * @property {PoseRecord} result
 * @property {PoseRecord} result_now
 * @property {(PoseRecord & {frame?: number}) | null} recorded  what the flight's run recorded
 * @property {PoseRecord | null} recorded_now
 * @property {string} recorded_version
 * @property {PoseRecord | null} alone  of a run's frame: the frame by itself
 * @property {PoseRecord | null} alone_now
 * @property {{offset: number, result: PoseRecord | null, picture: string | null}[]} neighbours
 */

import { ROOT, fileOf, request, send } from "./request.js";

/**
 * @param {import("./tuningApi.js").Reading} reading
 * @param {Record<string, string>} view  of the page's address
 * @returns {Promise<File>}
 */
export async function makeBundle({ subject, ...rest }, view) {
  const body = JSON.stringify({ ...subject, ...rest, view });
  const headers = { "Content-Type": "application/json", Accept: "application/zip, application/json" };
  return fileOf(await send(`${ROOT}/bundles`, { method: "POST", headers, body }), "bundle.zip");
}

/**
 * @param {File} file
 * @returns {Promise<import("./answers.js").DetectAnswer & {bundle: Bundle}>}
 */
export const openBundle = (file) => request("POST", "/bundles/open", { form: { file } });
