/**
 * Charts of a flight's figures over time, each of a few columns of the trajectory.
 *
 * @typedef {import("../figuresLogic.js").Figures} Figures
 * @typedef {import("../figuresLogic.js").Palette} Palette
 * @typedef {import("../../shared/components/plot.js").Chart} Chart
 */

import { abscissa } from "../figuresLogic.js";
import { stageName } from "../flightLogic.js";

/** @type {Record<string, {title: string, unit: string, columns?: [string, string][], units?: Record<string, string>, log?: boolean}>} */
export const SERIES = {
  attitude: { title: "Degrees", unit: "°", columns: [["heading_deg", "Heading"], ["tilt_deg", "Tilt"]] },
  sigma: {
    title: "One sigma: mm, degrees", unit: "", log: true,
    units: { position_sigma_mm: " mm", attitude_sigma_deg: "°" },
    columns: [["position_sigma_mm", "Position, mm"], ["attitude_sigma_deg", "Attitude, °"]],
  },
  cells: { title: "Cells", unit: " cells", columns: [["cells_read", "Read"], ["cells_wrong", "That differ"]] },
  times: { title: "Milliseconds", unit: " ms" },
};
/** Stages that take long enough to be seen; the others are in the total. */
const MOST_STAGES = 5;

/**
 * The columns of a chart that hold anything, with their names.
 * @param {Figures} figures
 * @param {string} chart
 * @returns {[string, string][]}
 */
export function seriesColumns({ trajectory }, chart) {
  const columns = /** @type {Record<string, (number | null)[]>} */ (/** @type {unknown} */ (trajectory));
  const sum = (/** @type {string} */ name) => columns[name].reduce((/** @type {number} */ all, value) => all + (value ?? 0), 0);
  if (chart === "times") {
    const stages = Object.keys(columns).filter((name) => name.endsWith("_ms") && name !== "total_ms");
    const longest = stages.sort((a, b) => sum(b) - sum(a)).slice(0, MOST_STAGES);
    const named = longest.map((name) => /** @type {[string, string]} */ ([name, stageName(name.slice(0, -3))]));
    return columns.total_ms ? [["total_ms", "Total"], ...named] : named;
  }
  return (SERIES[chart].columns ?? []).filter(([name]) => columns[name]?.some((value) => value !== null));
}

/**
 * @param {Figures} figures
 * @param {Figures | null} other  of a second run
 * @param {string} chart
 * @param {Palette} palette
 * @returns {Chart}
 */
export function seriesChart(figures, other, chart, palette) {
  const { title, unit, units, log } = SERIES[chart];
  const colours = chart === "times" ? [palette.ink, ...palette.stages] : [palette.height, palette.x];
  const traces = (/** @type {Figures} */ run, /** @type {boolean} */ isOther) =>
    seriesColumns(run, chart).map(([name, words], at) => ({
      type: "scatter",
      mode: "lines",
      name: isOther ? `${words}, other run` : words,
      x: abscissa(run.trajectory).values,
      y: /** @type {any} */ (run.trajectory)[name],
      customdata: run.trajectory.frame,
      connectgaps: false,
      line: { color: colours[at], width: isOther ? 1 : 1.5, dash: isOther ? "dot" : "solid" },
      hovertemplate: `%{y:.4~g}${units?.[name] ?? unit}<extra>${words}, frame %{customdata}</extra>`,
    }));
  return {
    data: [...(other ? traces(other, true) : []), ...traces(figures, false)],
    layout: {
      xaxis: { title: abscissa(figures.trajectory).title },
      yaxis: { title, ...(log ? { type: "log" } : { rangemode: "tozero" }) },
      showlegend: true,
    },
  };
}
