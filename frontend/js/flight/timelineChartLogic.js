/**
 * The timeline as a chart: heights above, outcomes as strips below.
 *
 * @typedef {import("../shared/components/plot.js").Chart} Chart
 * @typedef {import("../shared/components/plot.js").Colours} Colours
 * @typedef {import("./timelineLogic.js").Column} Column
 * @typedef {import("./timelineLogic.js").Part} Part
 * @typedef {import("./timelineLogic.js").Timeline} Timeline
 * @typedef {{timeline: Timeline, other: Timeline | null, part: Part}} Shown  `other` of a second run
 */

import { length } from "../shared/formatLogic.js";
import { countOf, failedOf, heightMarks, heightRange, OUTCOMES } from "./timelineLogic.js";

const STRIP_PX = 16;
const GAP_PX = 6;
const TOP_PX = 4;
/** Cells of a strip, one above the other; the fewest that a column with a failure shows as failed. */
const CELLS = 11;
const LEAST_FAILED = 3;
/** Columns so wide are single frames, and stand apart. */
const APART_FROM_PX = 5;
const CHANNELS = ["red", "blue"];
/** What a channel's cell may be, from the foot up, and its colour; `own` has the channel's. */
const KINDS = [
  ["own", ""], ["bearing", "bearing"], ["outline", "accent"], ["other", "line-strong"], ["unseen", "line-strong"],
  ["file", "stage-file"], ["light", "stage-light"], ["edges", "stage-edges"], ["lines", "stage-lines"],
  ["grid", "stage-grid"], ["decode", "stage-decode"], ["pose", "stage-pose"],
];
const FIRST_FAILED = KINDS.findIndex(([kind]) => kind === "unseen");
/** @type {Record<string, string>} */
const KIND_OF_STAGE = {
  read: "file", stretch: "light", denoise: "light", unmix: "light", channel: "light", block_mean: "light",
  clean: "light", edges: "edges", lines: "lines", grid: "grid", decode: "decode", choose: "pose", pose: "pose",
  outline: "grid",
};

/**
 * @param {Shown} shown
 * @param {Colours} colour
 * @param {number} width  pixels
 * @param {number} height
 * @returns {Chart}
 */
export function timelineChart({ timeline, other, part }, colour, width, height) {
  const pixel = (part.last - part.first + 1) / width;
  const range = heightRange(timeline.columns, other?.columns ?? []);
  const runs = (other ? [timeline, other] : [timeline]).flatMap((run) =>
    CHANNELS.map((channel) => ({ run, channel })));
  const strips = runs.length * STRIP_PX + (runs.length - 1) * (GAP_PX / 2);
  const share = (/** @type {number} */ px) => Math.min(1, Math.max(0, px / height));
  const data = runs.map(({ run, channel }, at) => ({ ...stripOf(run, channel, pixel, colour), yaxis: `y${at + 2}` }));
  /** @type {Record<string, any>} */
  const layout = {
    margin: { l: 0, r: 0, t: 0, b: 0 },
    showlegend: false,
    xaxis: { range: [part.first - 0.5, part.last + 0.5], visible: false },
    yaxis: { domain: [share(strips + GAP_PX), 1 - share(TOP_PX)], visible: false },
    shapes: [],
  };
  runs.forEach((_, at) => {
    const foot = strips - STRIP_PX - at * (STRIP_PX + GAP_PX / 2);
    const domain = [share(foot), share(foot + STRIP_PX)];
    layout[`yaxis${at + 2}`] = { domain, range: [0, CELLS], visible: false };
    layout.shapes.push({
      type: "rect", layer: "below", xref: "paper", x0: 0, x1: 1, yref: "paper", y0: domain[0], y1: domain[1],
      fillcolor: colour("line"), line: { width: 0 },
    });
  });
  if (!range) return { data, layout };
  Object.assign(layout.yaxis, heightAxis(range, colour));
  const lines = [lineOf(timeline, pixel, { color: colour("ink"), width: 1.5 })];
  if (other) lines.unshift(lineOf(other, pixel, { color: colour("ink-3"), width: 1 }));
  return { data: [...data, ...lines], layout };
}

/** @param {{low: number, high: number}} range  mm @param {Colours} colour */
function heightAxis({ low, high }, colour) {
  const marks = heightMarks({ low, high });
  return {
    visible: true, range: [low, high], tickvals: marks, ticktext: marks.map(length), zeroline: false,
    ticklabelposition: "inside top", tickfont: { size: 11, color: colour("ink-3") },
  };
}

/** @param {Timeline} timeline @param {Column} column @returns {number} the middle, frames */
const middleOf = ({ first_frame: first, frames_per_column: size }, { column }) =>
  first + (column + 0.5) * size - 0.5;

/**
 * A line through the columns, broken where frames have no pose.
 * @param {Timeline} timeline
 * @param {number} pixel  frames
 * @param {{color: string, width: number}} line
 */
export function lineOf(timeline, pixel, line) {
  /** @type {(number | null)[]} */
  const x = [];
  /** @type {(number | null)[]} */
  const y = [];
  let last = -2;
  for (const column of timeline.columns) {
    if (column.z_min_mm === null) continue;
    const middle = middleOf(timeline, column);
    if (column.column !== last + 1) {
      // A column that stands alone is a dot.
      x.push(null, middle - pixel);
      y.push(null, column.z_max_mm);
    }
    x.push(middle, middle);
    y.push(column.z_max_mm, column.z_min_mm);
    last = column.column;
  }
  return { type: "scatter", mode: "lines", x, y, line };
}

/**
 * What became of a channel in all columns, as the cells of a picture.
 * @param {Timeline} timeline
 * @param {string} channel
 * @param {number} pixel  frames
 * @param {Colours} colour
 */
function stripOf(timeline, channel, pixel, colour) {
  const { first_frame: first, last_frame: last, frames_per_column: size } = timeline;
  const count = Math.ceil((last - first + 1) / size);
  const z = Array.from({ length: CELLS }, () => /** @type {(number | null)[]} */ (new Array(count).fill(null)));
  for (const column of timeline.columns) {
    cellsOf(column, channel).forEach((kind, cell) => {
      z[cell][column.column] = kind;
    });
  }
  const steps = KINDS.flatMap(([, name], at) =>
    [at, at + 1].map((edge) => [edge / KINDS.length, colour(name || channel)]));
  return {
    type: "heatmap", z, x0: first + size / 2 - 0.5, dx: size, y0: 0.5, dy: 1, zmin: -0.5, zmax: KINDS.length - 0.5,
    colorscale: steps, showscale: false, xgap: size / pixel > APART_FROM_PX ? 1 : 0,
    // Without any gap Plotly writes a style into the picture, which the page's policy forbids.
    ygap: 0.001,
  };
}

/**
 * A column's frames by what a channel gave, in frames.
 * @param {Column} column
 * @param {string} channel
 * @returns {Record<string, number>} by kind
 */
export function kindsOf(column, channel) {
  const by = (/** @type {string} */ name) => column.outcomes[OUTCOMES.indexOf(name)] ?? 0;
  const others = ["red", "green", "blue"].filter((name) => name !== channel);
  /** @type {Record<string, number>} */
  const kinds = {
    own: by(channel), bearing: by("bearing"), outline: by("outline"),
    other: others.reduce((sum, name) => sum + by(name), 0),
  };
  // Of many frames, and of flights of an older program, only the frame's own stage is known.
  const isKnown = Object.keys(column.failed_at ?? {}).length > 0;
  const stages = (isKnown ? column.failed_at?.[channel] : column.stages) ?? {};
  let rest = failedOf(column);
  for (const [stage, count] of Object.entries(stages)) {
    const kind = KIND_OF_STAGE[stage] ?? "pose";
    kinds[kind] = (kinds[kind] ?? 0) + count;
    rest -= count;
  }
  return { ...kinds, unseen: Math.max(rest, 0) };
}

/**
 * The cells of a channel in a column, by the shares of its frames, from the foot up; a single failure is seen.
 * @param {Column} column
 * @param {string} channel
 * @returns {number[]} places in KINDS
 */
export function cellsOf(column, channel) {
  const kinds = kindsOf(column, channel);
  const total = countOf(column);
  let sum = 0;
  const ends = KINDS.map(([kind]) => (sum += kinds[kind] ?? 0) / total);
  const failed = KINDS.map((_, at) => at).filter((at) => at >= FIRST_FAILED && kinds[KINDS[at][0]]);
  const most = failed.reduce((best, at) => (kinds[KINDS[at][0]] > (kinds[KINDS[best]?.[0]] ?? 0) ? at : best), failed[0]);
  return Array.from({ length: CELLS }, (_, cell) => {
    const found = ends.findIndex((end) => end > (cell + 0.5) / CELLS);
    return failed.length && cell >= CELLS - LEAST_FAILED && found < FIRST_FAILED ? most : found;
  });
}

/** What the strips show at present, for the legend. @param {Timeline[]} runs @returns {string[]} kinds */
export function kindsShown(runs) {
  const shown = new Set(runs.flatMap(({ columns }) => columns.flatMap((column) =>
    CHANNELS.flatMap((channel) => Object.entries(kindsOf(column, channel)).flatMap(([kind, count]) => (count ? [kind] : []))))));
  return KINDS.map(([kind]) => kind).filter((kind) => shown.has(kind));
}
