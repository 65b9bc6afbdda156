/**
 * What a bundle says of its frame, and what is otherwise here, in words.
 *
 * @typedef {import("../server/bundleApi.js").Bundle} Bundle
 * @typedef {import("../server/answers.js").PoseRecord} PoseRecord
 *
 * @typedef {object} Row
 * @property {string} name
 * @property {string} then
 * @property {string} now
 * @property {import("../server/bundleApi.js").Difference[]} differences
 */

import { length } from "../shared/formatLogic.js";
import { isBearing } from "../shared/poseLogic.js";
import { paramsToText } from "../shared/workbench/paramsLogic.js";
import { reasonInWords, stageTitle } from "../shared/stagesLogic.js";

const WORDS_OF_A_VALUE = 60;

/**
 * The bundle's view as an address, under its own parameters.
 * @param {Bundle} bundle
 * @returns {URLSearchParams}
 */
export function queryOf({ view, params }) {
  const query = new URLSearchParams(view);
  const set = paramsToText(params);
  if (set) query.set("set", set);
  else query.delete("set");
  // The pose of a flight's next frame is not at hand here.
  if (query.get("cells") === "neighbour") query.delete("cells");
  return query;
}

/** @param {PoseRecord | null} record @returns {string} */
export function outcome(record) {
  if (!record) return "no result";
  if (record.status !== "ok") return `${stageTitle(record.stage ?? "")}: ${reasonInWords(record.reason ?? "")}`;
  if (isBearing(record)) return `${length(record.range_mm ?? 0)} away, bearing only`;
  return `pose, ${length(record.position_mm?.[2] ?? 0)} up, ${record.layer}`;
}

/**
 * Each result that the bundle holds, then and now.
 * @param {Bundle} bundle
 * @returns {Row[]}
 */
export function rowsOf(bundle) {
  const row = (/** @type {string} */ name, /** @type {PoseRecord | null} */ then, /** @type {PoseRecord | null} */ now,
    /** @type {Row["differences"]} */ differences) => ({ name, then: outcome(then), now: outcome(now), differences });
  if (bundle.reading === "still") return [row("The picture", bundle.result, bundle.result_now, bundle.differences)];
  const version = bundle.recorded_version ? ` (version ${bundle.recorded_version})` : "";
  const rows = [row("Read as the run does", bundle.result, bundle.result_now, bundle.differences)];
  if (bundle.recorded) {
    rows.unshift(row(`Recorded by the run${version}`, bundle.recorded, bundle.recorded_now, bundle.recorded_differences));
  }
  if (bundle.alone) rows.push(row("The frame by itself", bundle.alone, bundle.alone_now, bundle.alone_differences));
  return rows;
}

/** @param {Bundle} bundle @returns {string} */
export function verdictOf({ same, versions }) {
  if (same) return "This install gives the very same result.";
  return `This install gives another result${versions.length ? "; its versions differ, too" : ", with the same versions"}.`;
}

/** @param {Bundle} bundle @returns {string} what of several results the page shows */
export const shownNote = ({ reading }) => (reading === "still" ? "" :
  "The frame is of a flight. This page shows it by itself; the run also knew the frames before it.");

/** @param {Bundle} bundle @returns {string} empty where none differs */
export function versionsInWords({ versions }) {
  const parts = versions.map(({ name, then, now }) => `${name} ${then ?? "none"} in the bundle, ${now ?? "none"} here`);
  return parts.length ? `Versions: ${parts.join("; ")}.` : "";
}

/** @param {unknown} value @returns {string} */
export function valueInWords(value) {
  const text = value === null || value === undefined ? "nothing" : typeof value === "string" ? value : JSON.stringify(value);
  return text.length > WORDS_OF_A_VALUE ? `${text.slice(0, WORDS_OF_A_VALUE)}…` : text;
}

/** @param {Bundle["neighbours"][number]} neighbour @returns {string} */
export const neighbourTitle = ({ offset, result }) =>
  `The frame ${offset < 0 ? "before" : "after"}${result ? `: ${outcome(result)}` : ""}`;
