/**
 * Heights against tilts: where each layer reads, dead bands, wanted heights, simulated frames.
 *
 * @typedef {import("../shared/coverageLogic.js").MethodCoverage} MethodCoverage
 * @typedef {import("../shared/coverageLogic.js").Frame} Frame
 * @typedef {{tiltDeg: number, heightMm: number}} Place
 *
 * @typedef {object} CoverageChartState
 * @property {MethodCoverage | null} coverage  of the chosen method, filled
 * @property {MethodCoverage | null} other  of the other method, outlined
 * @property {{lowMm: number, highMm: number} | null} wish
 * @property {Place[]} frames  to be pictured
 * @property {(Place & {share: number})[]} dots  of a simulated map
 */

import {
  areaPath, bandRuns, heightRange, layerInWords, layersOf, logTicks, moved, placeInWords, placeOf, TILTS_DEG, widestOf,
  xOf, yOf,
} from "../shared/coverageLogic.js";
import { length } from "../shared/formatLogic.js";
import { draw, titled } from "../shared/components/svg.js";

const AXES = { left: 64, bottom: 40 };
// Figures at the ends of the axes reach over them.
const EDGE = { top: 8, right: 14 };
const LEAST_HEIGHT = 260;
const MOST_HEIGHT = 400;
const MOST_DEG = TILTS_DEG.at(-1) ?? 75;
const TILT_STEP_DEG = 15;

/**
 * @param {HTMLElement} root  holds an SVG and a line of words
 * @param {{onPlace: (place: Place) => void, onAim: (place: Place) => void}} events  a place chosen,
 *   and one that the arrow keys came to
 */
export function mountCoverageChart(root, { onPlace, onAim }) {
  const svg = /** @type {SVGSVGElement} */ (root.querySelector("svg"));
  const readout = /** @type {HTMLElement} */ (root.querySelector("[data-ref=readout]"));
  /** @type {CoverageChartState | null} */
  let state = null;
  /** @type {Frame | null} */
  let frame = null;

  /** @param {PointerEvent | MouseEvent} event @returns {Place | null} */
  function placeUnder(event) {
    const matrix = svg.getScreenCTM();
    if (!frame || !matrix) return null;
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    return placeOf(frame, x, y);
  }
  svg.addEventListener("pointermove", (event) => {
    const place = placeUnder(event);
    if (place && state?.coverage) readout.textContent = placeInWords(state.coverage, place);
  });
  svg.addEventListener("pointerleave", () => showHint());
  svg.addEventListener("click", (event) => {
    const place = placeUnder(event);
    if (place) onPlace(place);
  });

  svg.addEventListener("keydown", (event) => {
    const from = state?.frames[0];
    if (!from || !frame || event.ctrlKey || event.metaKey || event.altKey) return;
    const to = event.key === "Enter" ? from : moved(from, event.key, frame);
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

  function paint() {
    const outer = svg.clientWidth;
    if (!state?.coverage || !outer) return;
    const { coverage, other } = state;
    const outerHeight = Math.min(MOST_HEIGHT, Math.max(LEAST_HEIGHT, 0.6 * outer));
    const [width, height] = [outer - EDGE.right, outerHeight - EDGE.top];
    const range = heightRange(other ? [coverage, other] : [coverage]);
    frame = { ...AXES, width, height, ...range, mostDeg: MOST_DEG };
    svg.setAttribute("viewBox", `0 ${-EDGE.top} ${outer} ${outerHeight}`);
    svg.replaceChildren(
      ...axes(frame), ...areas(frame, coverage), ...bands(frame, coverage),
      ...(other ? outlines(frame, other) : []), ...marks(frame, state),
    );
  }
  new ResizeObserver(paint).observe(svg);

  let shown = "";
  return {
    /** @param {CoverageChartState} next */
    update(next) {
      const key = JSON.stringify(next);
      if (key === shown) return;
      shown = key;
      state = next;
      root.hidden = !next.coverage;
      paint();
      showHint();
    },
  };
}

/** @param {Frame} frame @returns {SVGElement[]} */
function axes(frame) {
  const { width, height, left, bottom } = frame;
  const foot = height - bottom;
  const heights = logTicks(frame.lowMm, frame.highMm).flatMap((tick) => {
    const y = yOf(frame, tick);
    return [
      draw("line", { x1: left, x2: width, y1: y, y2: y, class: "grid" }),
      draw("text", { x: left - 6, y: y + 4, class: "tick tick-y" }, length(tick).replace(/\.0+(?= )/, "")),
    ];
  });
  const tilts = [];
  for (let tilt = 0; tilt <= MOST_DEG; tilt += TILT_STEP_DEG) {
    const x = xOf(frame, tilt);
    tilts.push(
      draw("line", { x1: x, x2: x, y1: 0, y2: foot, class: "grid" }),
      draw("text", { x, y: foot + 16, class: "tick" }, `${tilt}°`),
    );
  }
  const middle = (left + width) / 2;
  return [...heights, ...tilts, draw("text", { x: middle, y: height - 4, class: "tick" }, "tilt of the camera")];
}

/** @param {MethodCoverage} coverage @param {string} layer */
const spansOf = (coverage, layer) => coverage.spans.filter((span) => span.layer === layer);

/** @param {Frame} frame @param {MethodCoverage} coverage @returns {SVGElement[]} */
function areas(frame, coverage) {
  // The whole sign lies over most of a layer: under it, the layer's colour stays.
  return layersOf(coverage).reverse().map((layer) => {
    const path = draw("path", { d: areaPath(frame, spansOf(coverage, layer)), class: `area area-${layer}` });
    return titled(path, `${layerInWords(layer)}, ${coverage.method} method`);
  });
}

/** @param {Frame} frame @param {MethodCoverage} other @returns {SVGElement[]} */
const outlines = (frame, other) =>
  layersOf(other).map((layer) =>
    draw("path", { d: areaPath(frame, spansOf(other, layer)), class: `outline area-${layer}` }),
  );

/** @param {Frame} frame @param {MethodCoverage} coverage @returns {SVGElement[]} */
function bands(frame, coverage) {
  const runs = bandRuns(coverage);
  if (!runs.length) return [];
  const widest = widestOf(runs.flat());
  const isLate = widest.tilt_deg > MOST_DEG / 2;
  const name = {
    x: xOf(frame, widest.tilt_deg) + (isLate ? -8 : 8),
    y: (yOf(frame, widest.low_mm) + yOf(frame, widest.high_mm)) / 2 + 4,
    "text-anchor": isLate ? "end" : "start",
    class: "dead-band-name",
  };
  return [
    ...runs.map((run) => titled(draw("path", { d: areaPath(frame, run), class: "dead-band" }), widestOf(run).message)),
    draw("text", name, "dead band"),
  ];
}

/** @param {Frame} frame @param {CoverageChartState} state @returns {SVGElement[]} */
function marks(frame, { wish, frames, dots }) {
  const lines = (wish ? [wish.lowMm, wish.highMm] : []).map((height) => {
    const y = yOf(frame, height);
    return draw("line", { x1: frame.left, x2: frame.width, y1: y, y2: y, class: "wish" });
  });
  const read = dots.map(({ tiltDeg, heightMm, share }) =>
    titled(
      draw("circle", {
        cx: xOf(frame, tiltDeg), cy: yOf(frame, heightMm), r: 5,
        class: `dot dot-${share >= 1 ? "all" : share > 0 ? "some" : "none"}`,
      }),
      `${length(heightMm)}, ${tiltDeg}°: ${Math.round(100 * share)} % read`,
    ),
  );
  const places = frames.map(({ tiltDeg, heightMm }) => {
    const [x, y] = [xOf(frame, tiltDeg), yOf(frame, heightMm)];
    return draw("path", { d: `M${x - 8} ${y} H${x + 8} M${x} ${y - 8} V${y + 8}`, class: "place" });
  });
  return [...lines, ...read, ...places];
}
