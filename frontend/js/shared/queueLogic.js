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
 * @property {boolean} [barred]  it is never sent, whatever it is read with
 * @property {boolean} [passing]  the server could not answer; a later try may go well
 * @property {[number, number] | null} [turned]  its width and height, where it was refused as turned by a quarter
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
  return { id: `f${count}`, name: file.name, file, status, answer: null, message: fault, barred: Boolean(fault) };
}

/**
 * @param {DetectAnswer} answer
 * @returns {Frame}
 */
export function frameOfAnswer(answer) {
  count += 1;
  const { source, status } = answer.result;
  const number = answer.bundle?.recorded?.frame ?? null;
  const name = number === null ? source : `${source}, frame ${number}`;
  return { id: `f${count}`, name, file: null, status, answer, message: "" };
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
 * All pictures that can be sent wait again, because the pad, the camera or the method changed. What has no file but
 * is kept by the server stays, as the workbench reads it anew; results without either go.
 * @param {Frame[]} frames
 * @returns {Frame[]}
 */
export function requeued(frames) {
  return frames
    .filter((frame) => frame.file || frame.answer?.trace)
    .map((frame) => (frame.file && !frame.barred ? waiting(frame) : frame));
}

/** @param {Frame} frame @returns {Frame} */
const waiting = (frame) => ({ ...frame, status: "waiting", answer: null, message: "", turned: null, passing: false });

/**
 * Pictures that the server could not answer for wait again; those that it refused stay so.
 * @param {Frame[]} frames
 * @returns {Frame[]}
 */
export const triedAgain = (frames) => frames.map((frame) => (frame.passing ? waiting(frame) : frame));

/**
 * A frame without a file as the workbench read it last.
 * @param {Frame} frame
 * @param {{result: PoseRecord & {source: string}, image: {width: number, height: number}, camera_scale: number}} look
 * @returns {Frame}
 */
export function withReading(frame, { result, image, camera_scale }) {
  const { answer, file } = frame;
  if (file || !answer) return frame;
  return { ...frame, status: result.status, answer: { ...answer, result, results: [result], image, camera_scale } };
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
 * What a dropped file is: a picture, a camera, a pad, a bundle, a part of a live recording, or what simulated
 * pictures show.
 * @param {string} name
 * @param {string} head  the text's beginning
 * @returns {"image" | "camera" | "pad" | "bundle" | "live" | "truth"}
 */
export function kindOfFile(name, head) {
  if (/\.zip$/i.test(name)) return "bundle";
  // A ROS 2 bag's folder has it beside its files.
  if (/^metadata\.yaml$/i.test(name)) return "truth";
  if (/\.(ya?ml|xml|txt|cameramodel)$/i.test(name)) return "camera";
  if (/\.json$/i.test(name) && /^\s*\[/.test(head)) return "truth";
  if (/\.jsonl$/i.test(name) || /^\s*\{\s*"format":\s*"padstudio\.live"/.test(head)) return "live";
  if (/\.json$/i.test(name)) return head.includes("padstudio.pad") ? "pad" : "camera";
  return "image";
}

/** @param {string} name of a file @returns {boolean} true where it is a video's */
export const isVideo = (name) => /\.(mp4|m4v|mov|mkv|avi|webm|ts|mts|m2ts)$/i.test(name);

/** @param {string} name of a file @returns {boolean} true where it is a robot's recording, or a zip, which may be one */
export const mayBeRecording = (name) => /\.(bag|mcap|db3|zstd|zip)$/i.test(name);

/** @param {string} name of a file @returns {boolean} true where it is a picture's */
export const isPicture = (name) => /\.(jpe?g|png|webp|tiff?|bmp)$/i.test(name);

/**
 * Why a file need not even be sent; empty where it may.
 * @param {{size: number, name?: string}} file
 * @param {number} maxBytes
 * @returns {string}
 */
export function faultBeforeUpload(file, maxBytes) {
  if (isVideo(file.name ?? "")) return "This is a video. Flights reads videos, frame by frame.";
  if (/\.(bag|mcap|db3)$/i.test(file.name ?? "")) return "This is a recording. Flights reads recordings, frame by frame.";
  if (file.size === 0) return "The file is empty. Choose a picture in JPEG, PNG, TIFF or WebP form.";
  if (maxBytes && file.size > maxBytes) {
    const mb = (/** @type {number} */ bytes) => Math.round(bytes / 1e6);
    return `The file is ${mb(file.size)} MB; the limit is ${mb(maxBytes)} MB. Send a smaller picture.`;
  }
  return "";
}
