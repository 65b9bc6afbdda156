/**
 * Asks the server how a pad lies on sheets and where a camera reads it, whenever that changed.
 *
 * @typedef {import("./printLogic.js").PadShape} PadShape
 * @typedef {import("./printLogic.js").SheetPlan} SheetPlan
 * @typedef {import("../shared/coverageLogic.js").CoverageChart} CoverageChart
 *
 * @typedef {object} Wish
 * @property {PadShape | null} shape
 * @property {Record<string, string> | null} options  of the print
 * @property {string} camera  id, or empty
 *
 * @typedef {object} QueryEvents
 * @property {(plan: SheetPlan | null, fault: string) => void} onPlan
 * @property {(chart: CoverageChart | null) => void} onChart
 */

import { makeLatestAnswer } from "../server/latestAnswer.js";
import { TILTS_DEG } from "../shared/coverageLogic.js";
import { planCoverage, planSheets } from "../server/planApi.js";
import { sheetOptions } from "./printLogic.js";

/** @param {QueryEvents} events */
export function makeSheetAndCoverageQueries({ onPlan, onChart }) {
  const sheets = makeLatestAnswer(onPlan);
  const charts = makeLatestAnswer((/** @type {CoverageChart | null} */ chart) => onChart(chart));
  return {
    /** @param {Wish} wish  an unchanged one asks nothing */
    want({ shape, options, camera }) {
      const chosen = options && sheetOptions(options);
      sheets.ask(shape && chosen ? JSON.stringify([shape, chosen]) : "", (signal) =>
        planSheets(/** @type {PadShape} */ (shape), chosen ?? {}, signal),
      );
      charts.ask(shape && camera ? JSON.stringify([shape, camera]) : "", (signal) =>
        planCoverage(/** @type {PadShape} */ (shape), camera, TILTS_DEG, signal),
      );
    },
  };
}
