/**
 * Talks to the server about experiments.
 *
 * @typedef {"queued" | "running" | "done" | "failed" | "cancelled"} ExperimentState
 *
 * @typedef {object} Experiment
 * @property {string} id
 * @property {string} kind
 * @property {string} name
 * @property {ExperimentState} state
 * @property {string} created_at
 * @property {Record<string, unknown>} order
 * @property {number} steps_done
 * @property {number} steps_total  0 before it has begun
 * @property {{code: string, message: string} | null} error
 *
 * @typedef {{text: string, verdict: string, sentence: string, because: string}} Claim
 * @typedef {{caption: string, columns: string[], rows: string[][], file: string}} ReportTable
 * @typedef {{file: string, caption: string, words: string}} ReportFigure
 *
 * @typedef {object} ReportSection
 * @property {string} title
 * @property {string[]} words
 * @property {Claim[]} claims
 * @property {ReportTable[]} tables
 * @property {ReportFigure[]} figures
 *
 * @typedef {{title: string, words: string[], sections: ReportSection[]}} Report
 * @typedef {{name: string, media_type: string, size_bytes: number}} ReportFile
 * @typedef {Experiment & {files: ReportFile[], result: Report | null}} ExperimentDetail
 */

import { path, request, ROOT } from "./request.js";

/** @param {Record<string, unknown> & {kind: string}} order @returns {Promise<Experiment>} */
export const startExperiment = (order) => request("POST", "/experiments", { json: order });

/** @returns {Promise<{items: Experiment[]}>} */
export const listExperiments = () => request("GET", "/experiments");

/** @param {string} id @returns {Promise<ExperimentDetail>} */
export const getExperiment = (id) => request("GET", path`/experiments/${id}`);

/** Stop one, or forget it where it is over. @param {string} id */
export const deleteExperiment = (id) => request("DELETE", path`/experiments/${id}`);

/** @param {string} id @param {string} name */
export const experimentFileUrl = (id, name) => ROOT + path`/experiments/${id}/files/${name}`;
