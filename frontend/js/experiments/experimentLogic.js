/**
 * What experiments are called and how far they are, in words.
 *
 * @typedef {import("../server/experimentsApi.js").Experiment} Experiment
 * @typedef {import("../server/experimentsApi.js").ReportFile} ReportFile
 */

import { bytes, moment, number } from "../shared/formatLogic.js";

/** @param {Pick<Experiment, "state"> | null} experiment */
export const isAtWork = (experiment) => experiment?.state === "queued" || experiment?.state === "running";

/**
 * What stands where a report will be.
 *
 * @param {Pick<Experiment, "state">[]} all
 */
export function reportInWords(all) {
  if (all.some(({ state }) => state === "done")) return "Open a run to read its report.";
  if (all.some(isAtWork)) return "The report stands here when all frames are read.";
  return "No report yet. Start a run: its figures, its tables and what holds will stand here.";
}

/** @param {Pick<Experiment, "state" | "steps_done" | "steps_total">} experiment */
export function progressInWords({ state, steps_done: done, steps_total: total }) {
  if (state === "queued") return "Waiting for a free worker …";
  return total ? `${number(done)} of ${number(total)} frames` : "Getting ready …";
}

/** What stands below its name in a list. @param {Experiment} experiment */
export function noteOf(experiment) {
  const { state, created_at: made, error } = experiment;
  if (isAtWork(experiment)) return progressInWords(experiment);
  if (state === "failed") return `failed: ${error?.message ?? "nobody knows why"}`;
  return state === "cancelled" ? "stopped" : moment(made);
}

/** Experiments of a kind, as the list shows them. @param {Experiment[]} all @param {string} kind */
export const ofKind = (all, kind) => all.filter((each) => each.kind === kind);

/** The files in the order in which people look for them. @param {ReportFile[]} files */
export function sortedFiles(files) {
  const rank = (/** @type {ReportFile} */ { name }) => [".html", ".md", ".csv"].findIndex((end) => name.endsWith(end)) >>> 0;
  return [...files].sort((a, b) => rank(a) - rank(b) || a.name.localeCompare(b.name));
}

/** @param {ReportFile} file */
export const fileInWords = ({ name, size_bytes: size }) => `${name}, ${bytes(size)}`;

/** How a verdict is shown. @param {string} verdict @returns {"ok" | "warn" | "bad" | "quiet"} */
export function verdictKind(verdict) {
  if (verdict === "held") return "ok";
  if (verdict === "held within") return "warn";
  return verdict === "does not hold" ? "bad" : "quiet";
}
