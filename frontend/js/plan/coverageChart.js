/**
 * The chart of heights against tilts: read under the pointer, aimed at by click and arrow keys.
 *
 * @typedef {import("./coverageChartLogic.js").Coverage} Coverage
 * @typedef {import("./coverageChartLogic.js").Place} Place
 * @typedef {Omit<Coverage, "coverage"> & {coverage: Coverage["coverage"] | null}} CoverageChartState
 */

import { coverageChart, MARGIN } from "./coverageChartLogic.js";
import { heightRange, moved, placeInWords, placeOf, TILTS_DEG } from "../shared/coverageLogic.js";
import { length } from "../shared/formatLogic.js";
import { mountPlot } from "../shared/components/plot.js";

const MOST_DEG = TILTS_DEG.at(-1) ?? 75;
const NEAR_PX = 7;

/**
 * @param {HTMLElement} root  holds a place for the chart and a line of words
 * @param {{onPlace: (place: Place) => void, onAim: (place: Place) => void}} events  a place chosen,
 *   and one that the arrow keys came to
 */
export function mountCoverageChart(root, { onPlace, onAim }) {
  const area = /** @type {HTMLElement} */ (root.querySelector("[data-ref=picture]"));
  const readout = /** @type {HTMLElement} */ (root.querySelector("[data-ref=readout]"));
  const plot = mountPlot(area);
  /** @type {CoverageChartState | null} */
  let state = null;

  function frame() {
    const { coverage = null, other = null } = state ?? {};
    return { ...heightRange([coverage, other].filter((each) => each !== null)), mostDeg: MOST_DEG };
  }

  /** @param {MouseEvent} event @returns {Place} */
  function placeUnder(event) {
    const box = area.getBoundingClientRect();
    const across = (event.clientX - box.left - MARGIN.l) / (box.width - MARGIN.l - MARGIN.r);
    const down = (event.clientY - box.top - MARGIN.t) / (box.height - MARGIN.t - MARGIN.b);
    return placeOf(frame(), across, 1 - down);
  }

  /** @param {Coverage["coverage"]} coverage @param {Place} place @returns {string} */
  function inWords(coverage, place) {
    const { highMm, lowMm } = frame();
    const near = state?.dots.find(({ tiltDeg, heightMm }) => {
      const across = ((tiltDeg - place.tiltDeg) / MOST_DEG) * area.clientWidth;
      const up = (Math.log(heightMm / place.heightMm) / Math.log(highMm / lowMm)) * area.clientHeight;
      return Math.hypot(across, up) < NEAR_PX;
    });
    if (!near) return placeInWords(coverage, place);
    return `${length(near.heightMm)}, ${near.tiltDeg}°: ${Math.round(100 * near.share)} % of the simulated pictures read`;
  }

  area.addEventListener("pointermove", (event) => {
    if (state?.coverage) readout.textContent = inWords(state.coverage, placeUnder(event));
  });
  area.addEventListener("pointerleave", () => showHint());
  area.addEventListener("click", (event) => {
    if (state?.coverage) onPlace(placeUnder(event));
  });
  area.addEventListener("keydown", (event) => {
    const from = state?.frames[0];
    if (!from || event.ctrlKey || event.metaKey || event.altKey) return;
    const to = event.key === "Enter" ? from : moved(from, event.key, frame());
    if (!to) return;
    event.preventDefault();
    if (event.key === "Enter") onPlace(to);
    else onAim(to);
  });

  function showHint() {
    const frames = state?.frames ?? [];
    readout.textContent =
      state?.coverage && frames.length === 1
        ? placeInWords(state.coverage, frames[0])
        : "Click a place to take a picture from there.";
  }

  let shown = "";
  return {
    /** @param {CoverageChartState} next */
    update(next) {
      const key = JSON.stringify(next);
      if (key === shown) return;
      shown = key;
      state = next;
      const { coverage } = next;
      root.hidden = !coverage;
      if (coverage) plot.show((colour) => coverageChart({ ...next, coverage }, frame(), colour));
      showHint();
    },
  };
}
