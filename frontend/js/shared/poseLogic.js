/**
 * A pose in words and figures, from a record of a poses file.
 *
 * @typedef {import("../server/answers.js").PoseRecord} PoseRecord
 */

import { duration, length, number, percent, powerOfTen } from "./formatLogic.js";
import { reasonInWords, stageTitle } from "./stagesLogic.js";

/** Below this a shift or a turn is nothing that a reader would act on. */
const NEGLIGIBLE_MM = 0.05;
const NEGLIGIBLE_DEG = 0.05;

/**
 * The outcome in one line.
 * @param {PoseRecord} record
 * @returns {string}
 */
export function verdict(record) {
  const found = isBearing(record) ? "Range and direction found" : "Pose found";
  if (record.status === "ok") return `${found} from the ${record.layer} ${layerNoun(record)}`;
  return `No pose: ${reasonInWords(record.reason ?? "")} at stage ${stageTitle(record.stage ?? "")}`;
}

/**
 * The name of the pad that a pose is of.
 * @param {PoseRecord} record
 * @param {import("../server/answers.js").KnownPad[]} pads  those that were looked for
 * @returns {string} its identity where it has no name; empty without a pose
 */
export const padName = ({ pad_id: printed = "" }, pads) =>
  pads.find((pad) => pad.pad_id === printed)?.name || printed;

/**
 * Which of several pads it is; empty where there is no choice.
 * @param {PoseRecord} record
 * @param {import("../server/answers.js").KnownPad[]} pads
 * @returns {string}
 */
export const padAmongSeveral = (record, pads) =>
  pads.length > 1 && record.status === "ok" ? `pad “${padName(record, pads)}”` : "";

/** @param {PoseRecord} record @returns {boolean} whether range and bearing alone can be used */
export const isBearing = (record) => record.status === "ok" && record.quality === "bearing";

/** @param {PoseRecord} record @returns {string} a word or two beside the verdict; empty for a full pose */
export function qualityBadge(record) {
  if (record.status !== "ok" || record.quality === "full") return "";
  return isBearing(record) ? "bearing only" : "quality unknown";
}

/**
 * Where the pad's centre is, seen by the camera.
 * @param {PoseRecord} record  with status ok
 * @returns {{right: number, down: number}} degrees from straight ahead, in the picture
 */
function direction({ bearing }) {
  const [x, y, z] = bearing ?? [0, 0, 1];
  const degrees = (/** @type {number} */ side) => (Math.atan2(side, z) * 180) / Math.PI;
  return { right: degrees(x), down: degrees(y) };
}

/** @param {PoseRecord} record @returns {string} such as "3.1° to the right and 1.0° up" */
function directionInWords(record) {
  const { right, down } = direction(record);
  const part = (/** @type {number} */ turn, /** @type {string} */ positive, /** @type {string} */ negative) =>
    Math.abs(turn) < NEGLIGIBLE_DEG ? "" : `${number(Math.abs(turn), 1)}° ${turn > 0 ? positive : negative}`;
  const parts = [part(right, "to the right", "to the left"), part(down, "down", "up")];
  return parts.filter(Boolean).join(" and ") || "straight ahead";
}

/** @param {PoseRecord} record  with status ok @returns {string} such as "16.20 m ± 90.0 mm, 3.1° to the right" */
export const rangeInWords = (record) => `${rangeText(record)}, ${directionInWords(record)}`;

/** @param {PoseRecord} record */
const rangeText = ({ range_mm: range = 0, range_sigma_mm: sigma }) =>
  `${length(range)}${typeof sigma === "number" ? ` ± ${length(sigma)}` : ""}`;

/**
 * Range and direction in figures.
 * @param {PoseRecord} record  with status ok
 * @returns {[string, string][]}
 */
export function rangeFacts(record) {
  if (record.range_mm === undefined) return [];
  const { right, down } = direction(record);
  const sigma = record.bearing_sigma_deg;
  /** @type {[string, string][]} */
  const facts = [["Range", rangeText(record)]];
  facts.push(["Right of straight ahead", `${number(right, 2)}°`], ["Below it", `${number(down, 2)}°`]);
  if (typeof sigma === "number") facts.push(["Direction ±", `${number(sigma, 3)}°`]);
  facts.push(["Bearing xyz", (record.bearing ?? []).map((part) => number(part, 4)).join(", ")]);
  return facts;
}

/**
 * Why the attitude is not to be used; empty where it is.
 * @param {PoseRecord} record
 * @returns {string}
 */
export function doubtInWords(record) {
  if (!isBearing(record)) return "";
  const shift = Math.hypot(...(record.position_sigma_mm ?? []));
  const turn = Math.hypot(...(record.attitude_sigma_deg ?? []));
  return `Not to be used: one standard deviation is ${number(turn, 1)}° of attitude and ${length(shift)} of place, ` +
    `${percent(shift, record.range_mm ?? 0)} of the distance. A pad that is small in the picture hardly shows its tilt.`;
}

/** @param {PoseRecord} record */
const layerNoun = (record) => (record.layer === "outline" ? "of the pad" : "layer");

/**
 * Where the camera is and how it looks, in sentences.
 * @param {PoseRecord} record  with status ok
 * @returns {string[]}
 */
export function poseInWords(record) {
  if (isBearing(record)) {
    return [`The pad's centre is ${rangeText(record)} away, ${directionInWords(record)}.`,
      "The camera's attitude, and so the place across, is too uncertain to use."];
  }
  const [x, y, z] = record.position_mm ?? [0, 0, 0];
  const side = shift(x, "to the right", "to the left");
  const along = shift(y, "up the page", "down the page");
  const shifts = [side, along].filter(Boolean).join(" and ");
  const where = shifts ? `${shifts} from the pad's centre` : "straight over the pad's centre";
  const tilt = record.tilt_deg ?? 0;
  const heading = record.heading_deg ?? 0;
  return [
    `The camera is ${length(z)} above the pad, ${where}.`,
    tilt < NEGLIGIBLE_DEG
      ? "It looks straight down."
      : `It looks ${number(tilt, 1)}° away from straight down.`,
    headingInWords(heading),
  ];
}

/** @param {number} mm @param {string} positive @param {string} negative */
function shift(mm, positive, negative) {
  if (Math.abs(mm) < NEGLIGIBLE_MM) return "";
  return `${length(Math.abs(mm))} ${mm > 0 ? positive : negative}`;
}

/** @param {number} heading @returns {string} */
function headingInWords(heading) {
  const turn = heading > 180 ? heading - 360 : heading;
  if (Math.abs(turn) < NEGLIGIBLE_DEG) return "The top of the picture is the top of the page.";
  const way = turn > 0 ? "clockwise" : "anticlockwise";
  return `The top of the picture points ${number(Math.abs(turn), 1)}° ${way} from the top of the page.`;
}

/**
 * The pose's figures, one line an axis or angle.
 * @param {PoseRecord} record  with status ok
 * @returns {[string, string][]}
 */
export function poseFacts(record) {
  const position = record.position_mm ?? [0, 0, 0];
  const sigma = record.position_sigma_mm;
  /** @type {[string, string][]} */
  const facts = ["X", "Y", "Z"].map((axis, at) => [
    axis,
    `${number(position[at], 2)}${sigma ? ` ± ${number(sigma[at], 2)}` : ""} mm`,
  ]);
  const turns = record.attitude_sigma_deg;
  facts.push(["Heading", `${number(record.heading_deg ?? 0, 2)}°`]);
  facts.push(["Tilt", `${number(record.tilt_deg ?? 0, 2)}°`]);
  if (turns) facts.push(["Attitude ±", `${turns.map((turn) => number(turn, 3)).join(", ")}°`]);
  const quaternion = record.quaternion_xyzw ?? [];
  facts.push(["Quaternion xyzw", quaternion.map((part) => number(part, 4)).join(", ")]);
  return facts;
}

/**
 * The pose alone, in the names and with all digits of a poses file.
 * @param {PoseRecord} record  with status ok
 * @returns {string}
 */
export const poseAsText = ({ position_mm, quaternion_xyzw, heading_deg, tilt_deg }) =>
  JSON.stringify({ position_mm, quaternion_xyzw, heading_deg, tilt_deg });

/**
 * What the pose rests on.
 * @param {PoseRecord} record  with status ok
 * @returns {import("./components/facts.js").Facts}
 */
export function evidenceFacts(record) {
  /** @type {import("./components/facts.js").Facts} */
  const facts = [["Layer", record.layer ?? "–"]];
  facts.push(["Cells read", number(record.cells_read ?? 0)]);
  facts.push(["Cells that differ", number(record.cells_wrong ?? 0)]);
  facts.push(["Reprojection", `${number(record.reprojection_px ?? 0, 3)} px`]);
  if (typeof record.flatness_mm === "number") facts.push(["Paper bent by", `${number(record.flatness_mm, 1)} mm`]);
  if (record.log10_false_alarm) {
    facts.push(["Chance of a false match", `below ${powerOfTen(Math.ceil(record.log10_false_alarm))}`]);
  }
  facts.push(["Time", duration(record.elapsed_ms?.total ?? 0)]);
  const latency = record.live?.latency_ms;
  if (typeof latency === "number") facts.push(["Known live", `${duration(latency)} after the frame came`]);
  if (record.pad_id) facts.push(["Pad's printed id", record.pad_id, record.pad_id]);
  return facts;
}
