/**
 * What the pages say of a flight.
 *
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 * @typedef {import("../server/flightsApi.js").Summary} Summary
 */

import { compact, duration, moment, number, percent } from "../shared/formatLogic.js";
import { paramsInWords } from "../shared/orderLogic.js";
import { methodInWords } from "../shared/readingLogic.js";
import { reasonInWords, stageTitle } from "../shared/stagesLogic.js";

/** @param {Flight} flight @returns {boolean} */
export const isRetryable = (flight) => flight.state === "failed" || flight.state === "cancelled";

/**
 * What was read with what.
 * @param {Flight} flight
 * @returns {import("../shared/components/facts.js").Facts}
 */
export function settingsFacts({ id, request, sources = [], created_at: created, started_at: started, finished_at: finished }) {
  /** @type {import("../shared/components/facts.js").Facts} */
  const facts = [
    ["Pad", request.pad_name ?? "–"],
    ["Camera", request.camera_name ?? "–"],
    ["Method", methodInWords(request.method)],
    ["Frames", rangeInWords(request)],
  ];
  const video = sources.find((source) => source.video)?.video;
  if (video) {
    facts.push(["Video", `${video.width} × ${video.height}, ${compact(video.fps, 2)} frames/s`]);
  }
  const params = paramsInWords(request.params ?? {});
  if (params) facts.push(["Parameters", params]);
  if (request.version) facts.push(["Version", request.version]);
  if (request.live) facts.push(["Recorded live", liveInWords(request.live)]);
  facts.push(["Flight's id", id, id], ["Pad's id", request.pad_id, request.pad_id]);
  facts.push(["Created", moment(created)]);
  if (started && finished) facts.push(["Took", duration(Date.parse(finished) - Date.parse(started))]);
  return facts;
}

/** @param {import("../server/flightsApi.js").LiveSession} session @returns {string} */
function liveInWords({ source, unix_s: began, is_whole: whole }) {
  const when = moment(new Date(1000 * began).toISOString());
  return `${when}${source ? `, from ${source}` : ""}${whole ? "" : ", broken off"}`;
}

/** @param {import("../server/flightsApi.js").FlightRequest} request @returns {string} */
export function rangeInWords({ first_frame: first = 0, end_frame: end, stride = 1, only }) {
  const range = end === null || end === undefined ? (first ? `from ${first}` : "all") : `${first} to ${end - 1}`;
  const some = stride > 1 ? `${range}, every ${ordinal(stride)}` : range;
  if (!only) return some;
  return `${some}, of these only failed ones${only.reason ? ` (${reasonInWords(only.reason)})` : ""}`;
}

/** @param {number} n */
function ordinal(n) {
  const tens = n % 100;
  const ending = tens > 10 && tens < 14 ? "th" : (["th", "st", "nd", "rd"][n % 10] ?? "th");
  return `${number(n)}${ending}`;
}

/**
 * Why it does not go on, damage, and other things that a user should know.
 * @param {Flight} flight
 * @returns {string[]}
 */
export function flightNotes({ notice, sources = [] }) {
  const found = sources.flatMap(({ name, video }) =>
    (video?.damage ?? []).map((/** @type {unknown} */ each) => `${name}: ${each}.`),
  );
  return notice ? [`Waiting: ${notice}.`, ...found] : found;
}

/**
 * The flight's figures.
 * @param {Summary} summary
 * @returns {[string, string][]}
 */
export function summaryFacts(summary) {
  const { frames, ok, qualities, longest_gap: gap, layers, damaged } = summary;
  if (!frames) return [["Frames", "none read yet"]];
  /** @type {[string, string][]} */
  const facts = [["With a pose", `${number(ok)} of ${number(frames)}, ${percent(ok, frames)}`]];
  facts.push(["Full poses", number(qualities.full)], ["Range and bearing only", number(qualities.bearing)]);
  if (qualities.unknown) facts.push(["Of unknown quality", number(qualities.unknown)]);
  facts.push(["Without a pose", number(frames - ok)]);
  facts.push(["Longest gap", gap ? gapInWords(gap) : "none"]);
  for (const [layer, count] of Object.entries(layers)) {
    facts.push([layer === "outline" ? "From the outline" : `From the ${layer} layer`, percent(count, ok)]);
  }
  if (damaged) facts.push(["Damaged in the file", `${number(damaged)} ${damaged === 1 ? "frame" : "frames"}`]);
  return facts;
}

/** @param {NonNullable<Summary["longest_gap"]>} gap @returns {string} */
export function gapInWords({ frames, seconds, first_frame: first }) {
  const size = frames === 1 ? "1 frame" : `${number(frames)} frames`;
  return `${size}${seconds === null ? "" : `, ${compact(seconds, 2)} s`}, from ${number(first)}`;
}

/**
 * Why frames failed, the most frequent first.
 * @param {Summary} summary
 * @returns {{reason: string, text: string, count: number}[]}
 */
export function reasonsOf({ reasons }) {
  return Object.entries(reasons)
    .sort(([, a], [, b]) => b - a)
    .map(([reason, count]) => ({ reason, text: `${reasonInWords(reason)} (${number(count)})`, count }));
}

/** @param {string | null} stage @returns {string} */
export const stageName = (stage) => (stage === "read" ? "Reading the file" : stageTitle(stage ?? ""));

/** The forms of a download; that for PX4 needs a file and is no plain link. */
export const EXPORTS = [
  { form: "csv", name: "CSV", about: "spreadsheets" },
  { form: "jsonl", name: "JSONL", about: "poses file, a frame a line" },
  { form: "tum", name: "TUM", about: "trajectory for evo" },
  { form: "colmap", name: "COLMAP", about: "images.txt" },
  { form: "mcap", name: "MCAP", about: "Foxglove" },
  { form: "mcap?images=true", name: "MCAP, frames", about: "Foxglove, with pictures" },
  { form: "ros2", name: "ROS 2 bag", about: "poses with covariance, tf" },
  { form: "ardupilot", name: "ArduPilot", about: "LANDING_TARGET" },
];

/**
 * Two runs side by side: what differs in how they were read.
 * @param {Flight} a
 * @param {Flight} b
 * @returns {string}
 */
export function differenceInWords(a, b) {
  const [one, other] = [settingsFacts(a), settingsFacts(b)];
  const skipped = ["Created", "Took", "Video", "Flight's id", "Pad's id"];
  const parts = [...new Set([...one, ...other].map(([term]) => term))]
    .filter((term) => !skipped.includes(term))
    .flatMap((term) => {
      const value = (/** @type {import("../shared/components/facts.js").Facts} */ facts) =>
        facts.find(([name]) => name === term)?.[1] ?? "default";
      return value(one) === value(other) ? [] : [`${term}: ${value(one)} / ${value(other)}`];
    });
  return parts.length ? parts.join("; ") : "the same settings";
}
