/**
 * The pictures on the Diagnose page and what became of each.
 *
 * @typedef {import("./poseLogic.js").PoseRecord} PoseRecord
 * @typedef {import("./stagesLogic.js").StageAnswer} StageAnswer
 * @typedef {import("../server/answers.js").DetectAnswer} DetectAnswer
 *
 * @typedef {object} Frame
 * @property {string} id
 * @property {string} name
 * @property {File | null} file  null for a result that was opened by its address
 * @property {"waiting" | "running" | "ok" | "failed" | "refused"} status
 * @property {DetectAnswer | null} answer
 * @property {string} message  why the server refused the picture
 */

import { length } from "./formatLogic.js";
import { isBearing } from "./poseLogic.js";
import { reasonInWords, stageTitle } from "./stagesLogic.js";

let count = 0;

/**
 * @param {File} file
 * @param {string} [fault]  why it is not even sent
 * @returns {Frame}
 */
export function newFrame(file, fault = "") {
  count += 1;
  const status = fault ? "refused" : "waiting";
  return { id: `f${count}`, name: file.name, file, status, answer: null, message: fault };
}

/**
 * @param {DetectAnswer} answer
 * @returns {Frame}
 */
export function frameOfAnswer(answer) {
  count += 1;
  const { source, status } = answer.result;
  return { id: `f${count}`, name: source, file: null, status, answer, message: "" };
}

/**
 * @param {Frame[]} frames
 * @param {string} id
 * @param {Partial<Frame>} change
 * @returns {Frame[]}
 */
export function withFrame(frames, id, change) {
  return frames.map((frame) => (frame.id === id ? { ...frame, ...change } : frame));
}

/**
 * All pictures wait again, because the pad, the camera or the method changed. Results without a
 * file cannot be made anew and go.
 * @param {Frame[]} frames
 * @returns {Frame[]}
 */
export function requeued(frames) {
  return frames
    .filter((frame) => frame.file)
    .map((frame) => ({ ...frame, status: "waiting", answer: null, message: "" }));
}

/**
 * The picture to read next: the selected one if it waits, else the first that does.
 * @param {Frame[]} frames
 * @param {string | null} selectedId
 * @returns {Frame | null}
 */
export function nextWaiting(frames, selectedId) {
  const waiting = frames.filter((frame) => frame.status === "waiting");
  return waiting.find((frame) => frame.id === selectedId) ?? waiting[0] ?? null;
}

/**
 * A frame's state in a few words.
 * @param {Frame} frame
 * @returns {string}
 */
export function frameNote(frame) {
  const result = frame.answer?.result;
  switch (frame.status) {
    case "waiting": return "waiting";
    case "running": return "reading …";
    case "refused": return "not readable";
    case "ok":
      if (result && isBearing(result)) return `${length(result.range_mm ?? 0)} away, bearing only`;
      return `${length(result?.position_mm?.[2] ?? 0)}, ${result?.layer}`;
    default: return `${stageTitle(result?.stage ?? "")}: ${reasonInWords(result?.reason ?? "")}`;
  }
}

/**
 * Counts in one line, for the head of the list and for screen readers.
 * @param {Frame[]} frames
 * @returns {string}
 */
export function tally(frames) {
  const number = (/** @type {Frame["status"][]} */ ...states) =>
    frames.filter((frame) => states.includes(frame.status)).length;
  const bearings = frames.filter(({ answer }) => answer && isBearing(answer.result)).length;
  const parts = [
    [number("ok") - bearings, "with a pose"],
    [bearings, "with range and bearing only"],
    [number("failed"), "without"],
    [number("refused"), "not readable"],
    [number("waiting", "running"), "to read"],
  ];
  return parts.filter(([n]) => n).map(([n, text]) => `${n} ${text}`).join(", ");
}

/**
 * What a dropped file is: a picture, a camera or a pad.
 * @param {string} name
 * @param {string} head  the text's beginning
 * @returns {"image" | "camera" | "pad"}
 */
export function kindOfFile(name, head) {
  if (/\.ya?ml$/i.test(name)) return "camera";
  if (/\.json$/i.test(name)) return head.includes("padstudio.pad") ? "pad" : "camera";
  return "image";
}

/**
 * Why a file need not even be sent; empty where it may.
 * @param {{size: number}} file
 * @param {number} maxBytes
 * @returns {string}
 */
export function faultBeforeUpload(file, maxBytes) {
  if (file.size === 0) return "The file is empty. Choose a picture in JPEG, PNG, TIFF or WebP form.";
  if (maxBytes && file.size > maxBytes) {
    const mb = (/** @type {number} */ bytes) => Math.round(bytes / 1e6);
    return `The file is ${mb(file.size)} MB; the limit is ${mb(maxBytes)} MB. Send a smaller picture.`;
  }
  return "";
}
