/**
 * What one run does otherwise than another, in words and as a chart.
 *
 * @typedef {import("../server/flightsApi.js").Comparison} Comparison
 * @typedef {import("../server/flightsApi.js").Change} Change
 * @typedef {import("../shared/components/plot.js").Chart} Chart
 */

import { compact, framesInWords, length, number, percent } from "../shared/formatLogic.js";
import { reasonInWords, stageTitle } from "../shared/stagesLogic.js";

/** A pose has moved from so far on, mm. */
export const LEAST_MM = 1;

/** Three digits are what a distance is told by. @param {number} value */
const short = (value) => compact(Number(value.toPrecision(3)), 3);

/** @param {Comparison} found @returns {string[]} sentences */
export function comparisonInWords({ frames, won, lost, both, neither, moved, only_first: first, only_second: second }) {
  if (!frames) return ["The runs have no frame in common."];
  const words = [`Of ${number(frames)} frames that both runs read, this one wins ${number(won)} and loses ${number(lost)}; ${number(both)} have a pose in both, ${number(neither)} in neither.`];
  if (moved) {
    const { median_mm: median, worst_mm: worst, worst_share: share, worst_frame: frame } = moved;
    const part = share === null ? "" : `, ${percent(share, 1)} of the distance`;
    words.push(`Poses in both lie ${short(median)} mm apart (median), at most ${short(worst)} mm${part}, in frame ${number(frame)}.`);
  }
  const alone = [first && `${framesInWords(first)} in the other run alone`, second && `${framesInWords(second)} in this one alone`].filter(Boolean);
  if (alone.length) words.push(`Left out: ${alone.join(", ")}.`);
  return words;
}

/**
 * What became of a frame.
 * @param {Change} change
 * @returns {{kind: string, word: string}}
 */
export function changeInWords({ kind, moved_mm: moved }) {
  if (kind !== "both") return { kind, word: { won: "won", lost: "lost", neither: "no pose in either" }[kind] };
  return (moved ?? 0) >= LEAST_MM ? { kind: "moved", word: "moved" } : { kind: "same", word: "the same" };
}

/** @param {import("../server/flightsApi.js").FrameRecord} record @returns {string} a run's result in a few words */
export function resultInWords({ status, layer = "", position_mm: position, stage, reason, quality }) {
  if (status !== "ok") return `${stageTitle(stage ?? "")}: ${reasonInWords(reason ?? "")}`;
  const from = quality === "bearing" ? `${layer}, bearing only` : layer;
  return [from, position ? `${length(position[2])} high` : ""].filter(Boolean).join(", ");
}

/** @param {Change} change @returns {{moved: string, share: string, turned: string}} */
export function figuresOf({ moved_mm: moved, moved_share: share, turned_deg: turned }) {
  return {
    moved: moved === null ? "" : `${short(moved)} mm`,
    share: share === null ? "" : `${compact(100 * share, 2)} %`,
    turned: turned === null ? "" : `${compact(turned, 2)}°`,
  };
}

/**
 * Frames won upwards, lost ones downwards, over the flight; a point leads to its first frame.
 * @param {Comparison} found
 * @param {import("../shared/components/plot.js").Colours} colour
 * @returns {Chart}
 */
export function changesChart({ columns }, colour) {
  const x = columns.map((each) => (each.first_frame + each.last_frame) / 2);
  const where = columns.map(({ first_frame: a, last_frame: b }) => (a === b ? `frame ${a}` : `frames ${a} to ${b}`));
  const bars = (/** @type {string} */ name, /** @type {number[]} */ y, /** @type {string} */ ink) => ({
    type: "bar", name, x, y, textposition: "none",
    text: y.map((count, at) => `${where[at]}: ${framesInWords(Math.abs(count))}`), customdata: columns.map((each) => each.first_frame),
    marker: { color: ink }, hovertemplate: `%{text}<extra>${name}</extra>`,
  });
  const most = Math.max(0, ...columns.map(({ won, lost }) => Math.max(won, lost)));
  return {
    data: [
      bars("Frames won", columns.map(({ won }) => won), colour("ok")),
      bars("Frames lost", columns.map(({ lost }) => -lost), colour("warn")),
    ],
    layout: {
      barmode: "relative", bargap: 0, xaxis: { title: "Frame" },
      yaxis: { title: "Frames", ...(most < 6 ? { dtick: 1 } : {}), ...(most ? {} : { range: [-1, 1] }) }, showlegend: true,
    },
  };
}
