/**
 * The stages of a trace in words.
 *
 * @typedef {import("../server/answers.js").Channel} Channel
 * @typedef {import("../server/answers.js").Failure} Failure
 * @typedef {import("../server/answers.js").StageAnswer} StageAnswer
 */

/** @type {Record<string, {title: string, about: string}>} */
const STAGES = {
  stretch: { title: "Stretch", about: "Darkest to 0, brightest to 255" },
  denoise: { title: "Denoise", about: "Median filter against specks" },
  unmix: { title: "Un-mix", about: "Colours taken apart by the test strip" },
  channel: { title: "Channel", about: "One colour taken apart" },
  block_mean: { title: "Block mean", about: "Brighter than the picture and its surroundings" },
  clean: { title: "Clean", about: "Erosion, then dilation" },
  edges: { title: "Edges", about: "Borders of cells" },
  lines: { title: "Lines", about: "Two families of grid lines" },
  grid: { title: "Grid", about: "The lattice of cell corners" },
  decode: { title: "Decode", about: "Levels read and found in the pad" },
  choose: { title: "Choose", about: "The channel that counts" },
  pose: { title: "Pose", about: "Where the camera is" },
  outline: { title: "Outline", about: "The whole pad from afar" },
};

const CHANNEL_ORDER = ["red", "green", "blue"];

/** @type {Record<string, string>} */
const REASONS = {
  no_contrast: "no contrast",
  underexposed: "underexposed",
  overexposed: "overexposed",
  no_edges: "no edges",
  too_few_lines: "too few lines",
  no_lattice: "no lattice",
  cells_too_small: "cells too small",
  cells_too_large: "cells too large",
  too_few_cells: "too few cells",
  unknown_code: "unknown code",
  motion_blur: "motion blur",
  crosstalk: "crosstalk between the channels",
  no_outline: "no outline",
  pose_rejected: "pose rejected",
  no_layer: "no layer",
  channels_swapped: "red and blue exchanged",
  mirrored: "mirrored",
  inverted: "inverted",
  black_frame: "black frame",
  defocus: "out of focus",
  another_pad: "another pad",
  covered: "covered",
  cut_off: "cut off by the picture's rim",
  no_pad: "no pad in view",
  monochrome: "no colours",
  wrong_camera: "wrong camera file",
  print_scale: "print out of proportion",
  warped: "paper not flat",
  dropped_live: "passed over in the live session",
};

/** @param {string} name @returns {string} */
export const stageTitle = (name) => STAGES[name]?.title ?? words(name);

/** What a stage does, in a few words. @param {string} name @returns {string} */
export const stageAbout = (name) => STAGES[name]?.about ?? "";

/** @param {string} reason @returns {string} */
export const reasonInWords = (reason) => REASONS[reason] ?? words(reason).toLowerCase();

/**
 * What a second look found besides a failure, or to doubt of a pose, as failures of no stage.
 * @param {import("../server/answers.js").PoseRecord} result
 * @returns {{where: string, failure: Failure}[]}
 */
export function findingsOf(result) {
  const word = result.status === "ok" ? "Doubt" : "Also";
  return (result.findings ?? []).map((finding) => ({
    where: `${word}: ${reasonInWords(finding.reason)}`,
    failure: { stage: "", ...finding },
  }));
}

/**
 * The stages of an answer, none where it holds no trace.
 * @param {{trace: {stages: StageAnswer[]} | null} | null | undefined} answer
 * @returns {StageAnswer[]}
 */
export const stagesOf = (answer) => answer?.trace?.stages ?? [];

/** The stages of all channels come last. @param {Channel | null} channel */
const rank = (channel) => (channel ? CHANNEL_ORDER.indexOf(channel) : CHANNEL_ORDER.length);

/**
 * Where each channel came to its end.
 * @param {StageAnswer[]} stages
 * @returns {{channel: Channel | null, failure: Failure}[]}
 */
export function failures(stages) {
  return stages
    .flatMap((run) => (run.failure ? [{ channel: run.channel, failure: run.failure }] : []))
    .sort((a, b) => rank(a.channel) - rank(b.channel));
}

/** @param {string} name @returns {string} */
function words(name) {
  const text = name.replaceAll("_", " ");
  return text.charAt(0).toUpperCase() + text.slice(1);
}
