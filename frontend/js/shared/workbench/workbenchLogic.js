/**
 * Which views a workbench has, how they are linked, and what has to be fetched for them.
 *
 * @typedef {import("../../server/tuningApi.js").StageLook} StageLook
 * @typedef {import("../../server/tuningApi.js").Part} Part
 * @typedef {import("../../server/tuningApi.js").Marks} Marks
 * @typedef {import("../viewportLogic.js").Viewport} Viewport
 * @typedef {{width: number, height: number}} Size
 *
 * @typedef {object} Place  where all views look: the frame's pixel in the middle
 * @property {number} x
 * @property {number} y
 * @property {number} zoom  1 shows the whole frame
 *
 * @typedef {{stage: string, channel: string | null}} ViewName
 */

import { fit } from "../viewportLogic.js";

/** The stages in their order, as the detector has them. */
export const STAGE_ORDER = [
  "stretch", "denoise", "unmix", "channel", "block_mean", "clean", "edges", "lines", "grid", "decode",
  "choose", "pose", "outline",
];
const CHANNELS = ["red", "green", "blue"];
/** Shown pixels a frame pixel at the most. */
export const MOST_SCALE = 40;
// A part is fetched with this share of the view beyond each edge, so that panning shows no gap at once.
const BEYOND = 0.15;

/** @param {ViewName} view @returns {string} */
export const keyOf = ({ stage, channel }) => `${channel ?? ""}/${stage}`;

/**
 * The stages that have pictures as rows: those of all channels, then one a channel.
 * @param {StageLook[]} stages
 * @returns {{columns: string[], shared: StageLook[], rows: {channel: string, runs: (StageLook | null)[]}[]}}
 */
export function arrange(stages) {
  const place = (/** @type {StageLook} */ run) => STAGE_ORDER.indexOf(run.name);
  const shown = stages.filter((run) => run.part || run.failure);
  const shared = shown.filter((run) => !run.channel).sort((a, b) => place(a) - place(b));
  const own = shown.filter((run) => run.channel);
  const columns = STAGE_ORDER.filter((name) => own.some((run) => run.name === name));
  const rows = CHANNELS.filter((channel) => own.some((run) => run.channel === channel)).map((channel) => ({
    channel,
    runs: columns.map((name) => own.find((run) => run.name === name && run.channel === channel) ?? null),
  }));
  return { columns, shared, rows };
}

/**
 * What is looked at first: where it failed, or the pose.
 * @param {{result: {status: string, stage?: string}, stages: StageLook[]}} look
 * @returns {ViewName}
 */
export function firstFocus({ result, stages }) {
  const pictured = stages.filter((run) => run.part);
  const failed = pictured.find((run) => run.failure && run.name === result.stage);
  const wanted = result.status === "ok" ? pictured.find((run) => run.name === "pose") : failed;
  const { name, channel } = wanted ?? pictured.at(-1) ?? { name: "frame", channel: null };
  return { stage: name, channel };
}

/**
 * A view's own viewport, in pixels from the frame's corner.
 * @param {Place | null} place  null: the whole frame
 * @param {Size} image
 * @param {Size} view
 * @returns {Viewport}
 */
export function viewportOf(place, image, view) {
  const whole = fit(image, view, 0);
  return place ? { x: place.x, y: place.y, scale: whole.scale * place.zoom } : whole;
}

/**
 * The place that all views share, from one view's viewport; null where it shows the whole frame.
 * @param {Viewport} viewport
 * @param {Size} image
 * @param {Size} view
 * @returns {Place | null}
 */
export function placeOf({ x, y, scale }, image, view) {
  const whole = fit(image, view, 0).scale;
  const zoom = Math.min(Math.max(scale / whole, 1), Math.max(1, MOST_SCALE / whole));
  if (zoom <= 1.001) return null;
  const within = (/** @type {number} */ value, /** @type {number} */ most) => Math.min(Math.max(value, 0), most);
  return { x: within(x, image.width), y: within(y, image.height), zoom };
}

/**
 * The part of the frame that a view shows, a little more; null where that is all of it.
 * @param {Place | null} place
 * @param {Size} image
 * @param {Size} view
 * @returns {Part | null}
 */
export function partOf(place, image, view) {
  if (!place) return null;
  const { scale } = viewportOf(place, image, view);
  const half = [(view.width / scale) * (0.5 + BEYOND), (view.height / scale) * (0.5 + BEYOND)];
  const round = (/** @type {number} */ value, /** @type {number} */ most) =>
    Math.round(Math.min(Math.max(value, 0), most));
  return [
    round(place.x - half[0], image.width), round(place.y - half[1], image.height),
    round(place.x + half[0], image.width), round(place.y + half[1], image.height),
  ];
}

/** @param {Place | null} place @returns {string | null} for the address */
export const placeToText = (place) =>
  place && [place.x.toFixed(1), place.y.toFixed(1), place.zoom.toFixed(3)].map((text) => String(Number(text))).join(",");

/** @param {string | null} text @returns {Place | null} */
export function placeFromText(text) {
  const [x, y, zoom] = (text ?? "").split(",").map((part) => (part ? Number(part) : NaN));
  return [x, y, zoom].every(Number.isFinite) && zoom > 1 ? { x, y, zoom } : null;
}

/** @param {[number, number][]} corners @returns {string | null} for the address */
export const cornersToText = (corners) => corners.flat().map((value) => String(Number(value.toFixed(2)))).join(",") || null;

/** @param {string | null} text @returns {[number, number][]} up to four; none where it is no list of them */
export function cornersFromText(text) {
  const values = (text ?? "").split(",").map((part) => (part.trim() ? Number(part) : NaN));
  const isList = values.length % 2 === 0 && values.length <= 8 && values.every((value) => Math.abs(value) < 1e6);
  return isList ? values.flatMap((value, at) => (at % 2 ? [] : [/** @type {[number, number]} */ ([value, values[at + 1]])])) : [];
}

/** @param {ViewName} view @returns {string} */
export const viewToText = ({ stage, channel }) => (channel ? `${channel}-${stage}` : stage);

/** @param {string | null} text @returns {ViewName | null} */
export function viewFromText(text) {
  const match = /^(?:(red|green|blue)-)?([a-z_]{1,30})$/.exec(text ?? "");
  return match ? { channel: match[1] ?? null, stage: match[2] } : null;
}

/**
 * The line nearest to a place, within reach.
 * @param {Marks["lines"]} lines
 * @param {{x: number, y: number}} at  frame pixels
 * @param {number} reach  frame pixels
 */
export function lineAt(lines, at, reach) {
  let best = null;
  let least = reach;
  for (const line of lines) {
    for (let k = 1; k < line.points.length; k += 1) {
      const off = distance(at, line.points[k - 1], line.points[k]);
      // A dropped line is what somebody asks about, where others lie as near.
      const rank = line.kind === "found" ? off : off * 0.8;
      if (rank < least) [least, best] = [rank, line];
    }
  }
  return best;
}

/**
 * @param {{x: number, y: number}} at
 * @param {[number, number]} a
 * @param {[number, number]} b
 */
function distance(at, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const along = dx || dy ? ((at.x - ax) * dx + (at.y - ay) * dy) / (dx * dx + dy * dy) : 0;
  const t = Math.min(Math.max(along, 0), 1);
  return Math.hypot(at.x - ax - t * dx, at.y - ay - t * dy);
}

const FAMILIES = ["columns", "rows"];

/** @param {Marks["lines"][number]} line @returns {string} */
export function lineInWords({ family, kind, number, text }) {
  const what = family === null ? "line" : `line of the ${FAMILIES[family]}`;
  const name = number === null ? what : `${what}, number ${number}`;
  return `${kind === "found" ? "" : `${kind} `}${name}${text ? `: ${text}` : ""}`;
}
