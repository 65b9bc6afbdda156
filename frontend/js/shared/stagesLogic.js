/**
 * The stages of a trace, arranged for the page.
 *
 * @typedef {import("../server/answers.js").Channel} Channel
 * @typedef {import("../server/answers.js").Failure} Failure
 * @typedef {import("../server/answers.js").StageAnswer} StageAnswer
 *
 * @typedef {object} StageCard
 * @property {string} name
 * @property {string} title
 * @property {string} about
 * @property {StageAnswer[]} runs  one a channel, or a single one that serves all
 * @property {boolean} failed
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
};

/** @param {string} name @returns {string} */
export const stageTitle = (name) => STAGES[name]?.title ?? words(name);

/** @param {string} reason @returns {string} */
export const reasonInWords = (reason) => REASONS[reason] ?? words(reason).toLowerCase();

/**
 * One card a stage, in the order they ran; the channels side by side.
 * @param {StageAnswer[]} stages
 * @returns {StageCard[]}
 */
export function arrangeStages(stages) {
  /** @type {Map<string, StageCard>} */
  const cards = new Map();
  for (const run of stages) {
    let card = cards.get(run.name);
    if (!card) {
      const about = STAGES[run.name]?.about ?? "";
      card = { name: run.name, title: stageTitle(run.name), about, runs: [], failed: false };
      cards.set(run.name, card);
    }
    // A stage that ran twice in a channel is shown as it ended.
    card.runs = [...card.runs.filter((other) => other.channel !== run.channel), run];
    card.runs.sort((a, b) => orderOf(a.channel) - orderOf(b.channel));
    card.failed = card.runs.some((each) => each.failure);
  }
  const known = Object.keys(STAGES);
  const place = (/** @type {StageCard} */ card) => {
    const at = known.indexOf(card.name);
    return at < 0 ? known.length : at;
  };
  return [...cards.values()].sort((a, b) => place(a) - place(b));
}

/**
 * The stages of an answer, none where it holds no trace.
 * @param {{trace: {stages: StageAnswer[]} | null} | null | undefined} answer
 * @returns {StageAnswer[]}
 */
export const stagesOf = (answer) => answer?.trace?.stages ?? [];

/**
 * The channels that a trace went through, in the order of the page's columns.
 * @param {StageAnswer[]} stages
 * @returns {Channel[]}
 */
export function channelsOf(stages) {
  const found = new Set(stages.map((run) => run.channel));
  return /** @type {Channel[]} */ (CHANNEL_ORDER).filter((channel) => found.has(channel));
}

/** @param {Channel | null} channel */
const orderOf = (channel) => (channel ? CHANNEL_ORDER.indexOf(channel) : -1);

/**
 * The card of the picture that sums the trace up.
 * @param {string | null} picture
 * @returns {StageCard[]}
 */
export function resultCards(picture) {
  if (!picture) return [];
  const run = { name: "result", channel: null, elapsed_ms: 0, failure: null, picture, thumbnail: null };
  const about = "Lattice, decoded cells and axes over the picture";
  return [{ name: "result", title: "Result", about, runs: [run], failed: false }];
}

/**
 * The runs of a stage that are shown for a wish: a channel, or "both" side by side. A stage that
 * does not have the channel shows what it has.
 * @param {StageCard} card
 * @param {string} wish
 * @returns {StageAnswer[]}
 */
export function runsFor(card, wish) {
  const pictured = card.runs.filter((run) => run.picture);
  if (wish === "both") return pictured;
  return [pictured.find((run) => run.channel === wish) ?? pictured[0]].filter(Boolean);
}

/**
 * Cards that have a picture to enlarge.
 * @param {StageCard[]} cards
 * @returns {StageCard[]}
 */
export const picturedCards = (cards) => cards.filter((card) => runsFor(card, "both").length);

/**
 * The stage before or after one, among those with a picture.
 * @param {StageCard[]} cards
 * @param {string} stage
 * @param {1 | -1} step
 * @returns {string | null}
 */
export function neighbour(cards, stage, step) {
  const pictured = picturedCards(cards);
  const at = pictured.findIndex((card) => card.name === stage);
  return at < 0 ? null : (pictured[at + step]?.name ?? null);
}

/**
 * The wishes that a stage can fulfil, in the order a key cycles through them.
 * @param {StageCard} card
 * @returns {string[]}
 */
export function wishes(card) {
  const channels = runsFor(card, "both").map((run) => run.channel ?? "");
  return channels.length > 1 ? [...channels, "both"] : [];
}

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
