/**
 * Simulated frames: one picture, a short descent or a sweep of tilts, from the texts of a form.
 *
 * @typedef {Record<string, string>} Texts
 *
 * @typedef {object} FrameWish  what the server is asked for, without pad and camera
 * @property {number} height_mm
 * @property {number} tilt_deg
 * @property {number} tilt_towards_deg
 * @property {number} heading_deg
 * @property {[number, number, number]} velocity_mm_s
 * @property {string} look
 * @property {string} ground
 * @property {number} seed
 */

import { compact, length, number } from "./formatLogic.js";

export const DEFAULT_FRAME = Object.freeze({
  kind: "one",
  height_mm: "1000",
  to_mm: "150",
  frames: "6",
  tilt_deg: "10",
  heading_deg: "30",
  speed_mm_s: "0",
  look: "clear",
  ground: "grass",
  seed: "1",
});
const KINDS = ["one", "descent", "tilts"];
const RANGES = /** @type {Record<string, [number, number, string]>} */ ({
  height_mm: [1, 1_000_000, "Height"],
  to_mm: [1, 1_000_000, "Down to"],
  frames: [2, 12, "Pictures"],
  tilt_deg: [0, 89, "Tilt"],
  heading_deg: [0, 360, "Heading"],
  speed_mm_s: [0, 100_000, "Speed"],
  seed: [0, 2 ** 31, "Seed"],
});
const WHOLE = ["frames", "seed"];
/** Fields that only some kinds look at. */
const ONLY = /** @type {Record<string, string[]>} */ ({
  to_mm: ["descent"], frames: ["descent", "tilts"], tilt_deg: ["one", "descent"],
});
const STEEPEST_DEG = 70;
// Far from a part of a turn, so that no two frames of a descent look alike.
const TURN_DEG = 137.5;

/** @param {string} name @param {string} kind @returns {boolean} whether a kind looks at a field */
export const isAsked = (name, kind) => ONLY[name]?.includes(kind) ?? true;

/**
 * @param {Texts} texts
 * @returns {{wishes: FrameWish[] | null, errors: Texts}}
 */
export function parseFrames(texts) {
  /** @type {Texts} */
  const errors = {};
  const kind = KINDS.includes(texts.kind) ? texts.kind : "one";
  for (const [key, [least, most, label]] of Object.entries(RANGES)) {
    const value = Number(texts[key]);
    const isFine = texts[key].trim() !== "" && value >= least && value <= most;
    if (isAsked(key, kind) && !(isFine && (Number.isInteger(value) || !WHOLE.includes(key)))) {
      errors[key] = `${label}: from ${compact(least)} to ${compact(most)}${WHOLE.includes(key) ? ", whole" : ""}.`;
    }
  }
  if (Object.keys(errors).length) return { wishes: null, errors };
  return { wishes: placesOf(kind, texts).map((place, index) => wishAt(texts, place, index)), errors };
}

/**
 * @param {string} kind
 * @param {Texts} texts
 * @returns {{heightMm: number, tiltDeg: number}[]}
 */
function placesOf(kind, texts) {
  const [height, low, tilt, frames] = ["height_mm", "to_mm", "tilt_deg", "frames"].map((key) => Number(texts[key]));
  if (kind === "one") return [{ heightMm: height, tiltDeg: tilt }];
  const shares = Array.from({ length: frames }, (_, place) => place / (frames - 1));
  if (kind === "tilts") return shares.map((share) => ({ heightMm: height, tiltDeg: STEEPEST_DEG * share }));
  return shares.map((share) => ({ heightMm: height * (low / height) ** share, tiltDeg: tilt }));
}

/**
 * @param {Texts} texts
 * @param {{heightMm: number, tiltDeg: number}} place
 * @param {number} index
 * @returns {FrameWish}
 */
function wishAt(texts, { heightMm, tiltDeg }, index) {
  const heading = (Number(texts.heading_deg) + TURN_DEG * index) % 360;
  const speed = Number(texts.speed_mm_s);
  const angle = (heading * Math.PI) / 180;
  return {
    height_mm: rounded(heightMm),
    tilt_deg: rounded(tiltDeg),
    tilt_towards_deg: heading,
    heading_deg: heading,
    velocity_mm_s: [rounded(speed * Math.sin(angle)), rounded(speed * Math.cos(angle)), 0],
    look: texts.look,
    ground: texts.ground,
    seed: Number(texts.seed) + index,
  };
}

const rounded = (/** @type {number} */ value) => Number(value.toFixed(3));

/** @param {Texts} texts @returns {Texts} what differs from the defaults */
export function framesToQuery(texts) {
  return Object.fromEntries(
    Object.entries(DEFAULT_FRAME)
      .filter(([key, text]) => texts[key] !== text)
      .map(([key]) => [key, texts[key]]),
  );
}

/** @param {URLSearchParams} query @returns {Texts} */
export function framesFromQuery(query) {
  return Object.fromEntries(
    Object.entries(DEFAULT_FRAME).map(([key, text]) => [key, query.get(key) ?? text]),
  );
}

/**
 * Where Diagnose takes the same pictures and reads them.
 * @param {{pad: string, camera: string, method: string}} reading
 * @param {Texts} texts
 * @returns {string}
 */
export function diagnoseLink({ pad, camera, method }, texts) {
  const simulate = new URLSearchParams({ kind: texts.kind, ...framesToQuery(texts) }).toString();
  return `/diagnose?${new URLSearchParams({ pad, camera, method, simulate })}`;
}

/** @param {FrameWish} wish @returns {string} a picture's file name */
export const frameName = ({ height_mm: height, tilt_deg: tilt, look }) =>
  `simulated ${Math.round(height)} mm, ${Math.round(tilt)} deg, ${look}.jpg`;

/** @param {FrameWish} wish @returns {string} */
export const frameInWords = ({ height_mm: height, tilt_deg: tilt }) =>
  `${length(height)}, ${number(tilt)}°`;

/**
 * The true pose, for a reader.
 * @param {{position_mm: number[], heading_deg: number, tilt_deg: number}} truth
 * @returns {[string, string][]}
 */
export function truthFacts({ position_mm: position, heading_deg: heading, tilt_deg: tilt }) {
  return [
    ...["X", "Y", "Z"].map((axis, place) => /** @type {[string, string]} */ ([axis, `${number(position[place], 1)} mm`])),
    ["Heading", `${number(heading, 1)}°`],
    ["Tilt", `${number(tilt, 1)}°`],
  ];
}
