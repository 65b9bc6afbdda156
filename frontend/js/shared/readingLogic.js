/**
 * What the Diagnose page offers and says, apart from its pictures.
 *
 * @typedef {import("../server/api.js").PadSummary} PadSummary
 * @typedef {import("../server/api.js").CameraSummary} CameraSummary
 * @typedef {import("./queueLogic.js").Frame} Frame
 * @typedef {import("./components/choice.js").Group} Group
 */

import { compact, length, number, size } from "./formatLogic.js";
import { isBearing, padName, rangeInWords } from "./poseLogic.js";

/** @param {PadSummary[]} pads @returns {Group[]} */
export function padGroups(pads) {
  const options = pads.map((pad) => ({ id: pad.id, text: `${pad.name}, ${size(...pad.size_mm)}` }));
  return [{ label: "Saved pads", options }];
}

/**
 * @param {CameraSummary[]} stored
 * @param {CameraSummary[]} presets
 * @returns {Group[]}
 */
export function cameraGroups(stored, presets) {
  const option = (/** @type {CameraSummary} */ camera) => ({
    id: camera.id,
    text: `${camera.name}, ${camera.width} × ${camera.height}`,
  });
  return [
    { label: "Calibrated", options: stored.filter((each) => !each.nominal).map(option) },
    { label: "Nominal", options: [...stored.filter((each) => each.nominal), ...presets].map(option) },
  ];
}

/**
 * Pads besides the chosen one.
 * @param {PadSummary[]} pads
 * @param {string} chosen
 */
export const otherPads = (pads, chosen) =>
  padGroups(pads.filter((pad) => pad.id !== chosen))[0].options;

/**
 * Ids of all pads that pictures may show, the chosen one first; those that are gone are left out.
 * @param {{pads: PadSummary[], pad: string, others: string[]}} state
 * @returns {string[]}
 */
export const padIds = ({ pads, pad, others }) =>
  [pad, ...others.filter((id) => id !== pad && pads.some((each) => each.id === id))];

/** @param {string} method @returns {string} as the choice of methods calls it */
export const methodInWords = (method) => (method === "paper" ? "One window (paper)" : "All cells (dense)");

/**
 * What several pads mean for a reading; empty where there is one.
 * @param {string[]} others
 * @param {string} method
 * @returns {string}
 */
export function othersNote(others, method) {
  if (!others.length) return "";
  if (method === "paper") return `${methodInWords(method)} reads one pad: choose ${methodInWords("dense")}, or untick the others.`;
  return `${others.length + 1} pads are looked for; the result says which it is.`;
}

/** @param {PadSummary | undefined} pad @returns {string} */
export function padNote(pad) {
  if (!pad) return "";
  const layers = pad.layers.map((layer) => `${layer.channel} ${layer.cols} × ${layer.rows}`);
  const unmixed = pad.crosstalk ? "; un-mixed by its test strip" : "";
  return `${layers.join(", ")}; window ${pad.window} × ${pad.window} cells, ${pad.levels} grey levels${unmixed}`;
}

/** @param {CameraSummary | undefined} camera @returns {string} */
export function cameraNote(camera) {
  if (!camera) return "";
  const lens = camera.model === "fisheye" ? "fisheye" : lensInWords(camera.distortion);
  const nominal = camera.nominal ? "; nominal, calibrate for accuracy" : "";
  return `focal length ${number(camera.focal_px, 1)} px, ${lens}${shutterInWords(camera)}${nominal}`;
}

/** @param {CameraSummary} camera  the shutter, where its file says what it is */
function shutterInWords({ readout_ms: readout = null }) {
  if (readout === null) return "";
  return readout === 0 ? ", global shutter" : `, shutter rolls ${number(readout, 1)} ms`;
}

/** @param {number | null} readout @returns {string} what the field holds; empty where unknown */
export const readoutText = (readout) => (readout === null ? "" : String(readout));

/** Most of a shutter, ms. */
const MOST_READOUT_MS = 1000;

/**
 * A readout time that was typed.
 * @param {string} text
 * @returns {{readout: number | null, fault: string}}
 */
export function readoutFrom(text) {
  const trimmed = text.trim();
  if (!trimmed) return { readout: null, fault: "" };
  const readout = Number(trimmed.replace(",", "."));
  if (readout >= 0 && readout <= MOST_READOUT_MS) return { readout, fault: "" };
  return { readout: null, fault: `Milliseconds from 0 (a global shutter) to ${MOST_READOUT_MS}, or nothing where it is unknown.` };
}

/** @param {number[]} distortion */
const lensInWords = (distortion) =>
  distortion.some((coefficient) => coefficient !== 0) ? "distortion calibrated" : "no distortion";

/**
 * The names under which the sample's pad and camera are stored, so that they come in only once.
 * @param {string} padText  JSON
 * @param {string} cameraText  ROS YAML
 * @returns {{pad: string, camera: string}}
 */
export function namesInSample(padText, cameraText) {
  const camera = /^camera_name:\s*(.+?)\s*$/m.exec(cameraText);
  return { pad: JSON.parse(padText).name, camera: camera ? camera[1] : "" };
}

/**
 * What limits the trust in a result.
 * @param {Frame | null} frame
 * @param {CameraSummary | undefined} camera
 * @returns {string[]}
 */
export function resultNotes(frame, camera) {
  const answer = frame?.answer;
  if (!answer) return [];
  const notes = alsoFound(answer);
  if (answer.camera_scale !== 1) {
    const { width, height } = answer.image;
    notes.push(
      `The picture is ${width} × ${height}, another size than the camera file's: its figures were ` +
        `scaled by ${compact(answer.camera_scale, 4)}.`,
    );
  }
  if (camera?.nominal && answer.result.status === "ok") {
    notes.push("The camera is nominal: distances may be off by several percent until it is calibrated.");
  }
  return notes;
}

/**
 * The pads that a picture shows besides the one that is told of in full.
 * @param {import("../server/answers.js").DetectAnswer} answer
 * @returns {string[]}
 */
function alsoFound({ results = [], pads = [] }) {
  return results.slice(1).map((record) => {
    const where = isBearing(record) ? rangeInWords(record) : `${length(record.position_mm?.[2] ?? 0)} below the camera`;
    return `Also in the picture: the pad “${padName(record, pads)}”, ${where}.`;
  });
}

/**
 * What is still needed before a picture can be read; empty where nothing is.
 * @param {{pad: string, camera: string, frames: Frame[]}} state
 * @returns {string}
 */
export function missing({ pad, camera, frames }) {
  const parts = [pad ? "" : "a pad", camera ? "" : "a camera", frames.length ? "" : "a picture"];
  const needed = parts.filter(Boolean);
  if (!needed.length) return "";
  const last = needed.pop();
  return `Choose ${needed.length ? `${needed.join(", ")} and ${last}` : last}.`;
}
