/**
 * A pose in words and figures, from a record of a poses file.
 *
 * @typedef {import("../server/answers.js").PoseRecord} PoseRecord
 */

import { duration, length, number, powerOfTen } from "./formatLogic.js";
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
  if (record.status === "ok") return `Pose found from the ${record.layer} ${layerNoun(record)}`;
  return `No pose: ${reasonInWords(record.reason ?? "")} at stage ${stageTitle(record.stage ?? "")}`;
}

/** @param {PoseRecord} record */
const layerNoun = (record) => (record.layer === "outline" ? "of the pad" : "layer");

/**
 * Where the camera is and how it looks, in sentences.
 * @param {PoseRecord} record  with status ok
 * @returns {string[]}
 */
export function poseInWords(record) {
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
 * What the pose rests on.
 * @param {PoseRecord} record  with status ok
 * @returns {[string, string][]}
 */
export function evidenceFacts(record) {
  /** @type {[string, string][]} */
  const facts = [["Layer", record.layer ?? "–"]];
  facts.push(["Cells read", number(record.cells_read ?? 0)]);
  facts.push(["Cells that differ", number(record.cells_wrong ?? 0)]);
  facts.push(["Reprojection", `${number(record.reprojection_px ?? 0, 3)} px`]);
  if (record.log10_false_alarm) {
    facts.push(["Chance of a false match", `below ${powerOfTen(Math.ceil(record.log10_false_alarm))}`]);
  }
  facts.push(["Time", duration(record.elapsed_ms?.total ?? 0)]);
  return facts;
}
