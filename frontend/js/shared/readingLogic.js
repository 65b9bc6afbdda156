/**
 * What the Diagnose page offers and says, apart from its pictures.
 *
 * @typedef {import("../server/api.js").PadSummary} PadSummary
 * @typedef {import("../server/api.js").CameraSummary} CameraSummary
 * @typedef {import("./queueLogic.js").Frame} Frame
 * @typedef {import("./components/choice.js").Group} Group
 */

import { compact, number, size } from "./formatLogic.js";

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

/** @param {PadSummary | undefined} pad @returns {string} */
export function padNote(pad) {
  if (!pad) return "";
  const layers = pad.layers.map((layer) => `${layer.channel} ${layer.cols} × ${layer.rows}`);
  const unmixed = pad.crosstalk ? "; un-mixed by its test strip" : "";
  return `${layers.join(", ")}; b ${pad.window}, Y ${pad.levels}${unmixed}`;
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
  const notes = [];
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
