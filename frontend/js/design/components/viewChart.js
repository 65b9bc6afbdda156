/**
 * Cells in view and pixels a cell against height, for the chosen camera; read under the pointer.
 *
 * @typedef {import("../padLogic.js").PadView} PadView
 * @typedef {import("../../shared/coverageLogic.js").CoverageChart} CoverageChart
 */

import { heightRange, ofMethod } from "../../shared/coverageLogic.js";
import { mountPlot } from "../../shared/components/plot.js";
import { seenInWords, viewChart, MARGIN } from "../viewChartLogic.js";

const HINT = "Solid: cells in view. Dotted: pixels a cell. Point at a height to read both.";

/** @param {HTMLElement} root  holds a place for the chart and a line of words */
export function mountViewChart(root) {
  const area = /** @type {HTMLElement} */ (root.querySelector("[data-ref=chart]"));
  const readout = /** @type {HTMLElement} */ (root.querySelector("[data-ref=readout]"));
  const empty = /** @type {HTMLElement} */ (root.querySelector("[data-ref=empty]"));
  const plot = mountPlot(area);
  /** @type {{pad: PadView, chart: CoverageChart} | null} */
  let shown = null;

  area.addEventListener("pointermove", (event) => {
    const coverage = ofMethod(shown?.chart ?? null, "dense");
    if (!shown || !coverage) return;
    const box = area.getBoundingClientRect();
    const across = (event.clientX - box.left - MARGIN.l) / (box.width - MARGIN.l - MARGIN.r);
    const { lowMm, highMm } = heightRange([coverage]);
    const height = lowMm * (highMm / lowMm) ** Math.min(1, Math.max(0, across));
    readout.textContent = seenInWords(shown.pad, shown.chart.view, height);
  });
  area.addEventListener("pointerleave", () => (readout.textContent = HINT));

  return {
    /** @param {{pad: PadView | null, chart: CoverageChart | null, camera: string}} state */
    update({ pad, chart, camera }) {
      const coverage = ofMethod(chart, "dense");
      const next = pad && chart && coverage ? { pad, chart } : null;
      empty.hidden = Boolean(camera);
      area.hidden = readout.hidden = !next;
      if (next?.pad === shown?.pad && next?.chart === shown?.chart) return;
      shown = next;
      readout.textContent = HINT;
      if (next && coverage) {
        plot.show((colour) => viewChart(next.pad, next.chart.view, coverage, colour));
      }
    },
  };
}
