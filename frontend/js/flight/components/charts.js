/**
 * The figures of a flight, drawn when they come into view, and not before.
 *
 * @typedef {import("../figuresLogic.js").Figures} Figures
 * @typedef {import("../timelineLogic.js").Timeline} Timeline
 * @typedef {import("../../shared/components/plot.js").Chart} Chart
 * @typedef {import("../../shared/components/plot.js").Colours} Colours
 *
 * @typedef {object} ChartState
 * @property {Figures | null} figures
 * @property {Figures | null} otherFigures  of a second run
 * @property {Timeline | null} coarse  the whole flight in few columns
 * @property {Timeline | null} otherCoarse
 * @property {import("../../server/answers.js").VehicleComparison | null} vehicle
 * @property {import("../padSurfaceLogic.js").PadPicture | null} pad
 * @property {{frame: number, timeS: number | null} | null} at  the frame that is looked at
 */

import * as logic from "../figuresLogic.js";
import { VEHICLE_CHARTS, vehicleChart, vehicleInWords, vehicleLines } from "../charts/vehicleChartLogic.js";
import { SERIES, seriesChart, seriesColumns } from "../charts/seriesChartLogic.js";
import { mountPlot } from "../../shared/components/plot.js";

/** Charts whose x axis is another than time. */
const UNTIMED = ["space", "heights"];

/**
 * @param {HTMLElement} root
 * @param {{onSeek: (frame: number) => void, onVisible: () => void}} events
 */
export function mountCharts(root, { onSeek, onVisible }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  /** @type {Map<string, ReturnType<typeof mountPlot>>} */
  const plots = new Map();
  /** @type {ChartState | null} */
  let state = null;
  let visible = false;
  /** @type {unknown[]} */
  let drawn = [];

  /** @param {string} name @param {string} note @param {((palette: logic.Palette) => Chart) | null} make */
  function show(name, note, make) {
    find(`${name}-note`).textContent = note;
    const figure = /** @type {HTMLElement} */ (find(name).closest(".chart"));
    figure.hidden = !make;
    if (!make) return;
    if (!plots.has(name)) plots.set(name, mountPlot(find(name), { onFrame: onSeek }));
    plots.get(name)?.show((colour) => make(paletteOf(colour)));
  }

  /** @param {string} name */
  function showNote(name) {
    const figure = /** @type {HTMLElement} */ (find(name).closest(".chart"));
    figure.hidden = false;
    find(name).hidden = true;
  }

  function draw() {
    if (!visible || !state?.figures || !state.coarse) return;
    const { figures, otherFigures, coarse, otherCoarse, vehicle, pad } = state;
    const wanted = [figures, otherFigures, coarse, otherCoarse, vehicle, pad];
    if (wanted.every((each, at) => each === drawn[at])) return;
    drawn = wanted;
    const { heights } = figures;
    const fails = coarse.columns.some((column) => Object.keys(column.stages).length);
    show("trajectory", logic.trajectoryInWords(figures), (palette) => logic.trajectoryChart(figures, otherFigures, palette));
    for (const name of /** @type {(keyof typeof SERIES)[]} */ (Object.keys(SERIES))) {
      const has = seriesColumns(figures, name).length > 0;
      show(name, "", has ? (palette) => seriesChart(figures, otherFigures, name, palette) : null);
    }
    show("outcomes", "", (palette) => logic.outcomesChart(coarse, otherCoarse, palette));
    show("stages", "", fails ? (palette) => logic.stagesChart(coarse, palette) : null);
    show("heights", logic.heightsInWords(heights), heights && ((palette) => logic.heightsChart(heights, palette)));
    for (const name of Object.keys(VEHICLE_CHARTS)) {
      const has = vehicle && vehicleLines(vehicle, name).length > 0;
      show(name, vehicle ? vehicleInWords(vehicle, name) : "", has ? (palette) => vehicleChart(vehicle, name, palette) : null);
      // Why there is nothing to be seen is worth a line, too.
      if (vehicle && !has && name === "vehicle-height") showNote(name);
    }
    show("space", logic.samplesInWords(figures.samples), (palette) => logic.spaceChart(figures, pad, palette));
  }

  new IntersectionObserver((entries) => {
    visible = entries.some((entry) => entry.isIntersecting);
    if (!visible) return;
    onVisible();
    draw();
  }, { rootMargin: "300px" }).observe(root);

  return {
    /** @param {ChartState & {enabled: boolean}} next */
    update({ enabled, ...next }) {
      root.hidden = !enabled;
      state = next;
      draw();
      const { figures, at } = next;
      if (!figures) return;
      const timed = logic.isTimed(figures.trajectory);
      const value = at ? (timed ? at.timeS : at.frame) : null;
      for (const [name, plot] of plots) if (!UNTIMED.includes(name)) plot.cursor(value);
      plots.get("space")?.mark(logic.markIn(figures, at?.frame ?? null));
    },
  };
}

/** @param {Colours} colour @returns {logic.Palette} */
const paletteOf = (colour) => ({
  x: colour("series-1"), y: colour("series-2"), height: colour("series-3"), other: colour("line-strong"),
  ok: colour("accent"), line: colour("line"), ink: colour("ink"), ink2: colour("ink-2"), pad: colour("line-strong"),
  stages: ["series-1", "series-2", "series-3", "series-4", "series-5", "series-6"].map(colour),
});
