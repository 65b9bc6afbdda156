/**
 * What the Live page says: figures, sight, and what is kept to go back to.
 *
 * @typedef {import("../server/liveApi.js").Session} Session
 * @typedef {import("../server/liveApi.js").Figures} Figures
 * @typedef {import("../server/answers.js").PoseRecord} PoseRecord
 *
 * @typedef {object} Shown  a frame with its picture
 * @property {import("../server/liveApi.js").LiveFrame} frame
 * @property {Blob} picture
 */

import { bytes, duration, framesInWords, number, percent } from "../shared/formatLogic.js";
import { isBearing } from "../shared/poseLogic.js";
import { reasonInWords } from "../shared/stagesLogic.js";

/** So long frames are kept, s; and no more pictures than a phone's memory bears. */
const KEPT_S = 10;
const MOST_BYTES = 120_000_000;
// Shares of frames from which a print is said to be read, and to be read at times.
const READ = 0.95;
const AT_TIMES = 0.3;
// Fewer frames tell nothing.
const ENOUGH = 5;

/** @typedef {{value: string, unit: string, sigma: string}} Figure */

/**
 * A length in the largest unit that still shows its last digit from afar.
 * @param {number} mm
 * @param {number | undefined} [sigma]
 * @returns {Figure}
 */
export function lengthFigure(mm, sigma) {
  const inMetres = Math.abs(mm) >= 1000;
  const [scale, decimals, unit] = inMetres ? [1000, 3, "m"] : [1, 0, "mm"];
  return { value: number(mm / scale, decimals), unit, sigma: sigma === undefined ? "" : `± ${sigmaText(sigma)}` };
}

/** @param {number} mm */
const sigmaText = (mm) => (mm >= 1000 ? `${number(mm / 1000, 1)} m` : `${number(mm, mm < 10 ? 1 : 0)} mm`);

/** @param {number} deg @param {number | undefined} [sigma] @returns {Figure} */
export const angleFigure = (deg, sigma) => ({
  value: number(deg, 1), unit: "°", sigma: sigma === undefined ? "" : `± ${number(sigma, sigma < 1 ? 2 : 1)}°`,
});

/**
 * The figures that are read from afar; where only range and bearing can be used, these.
 * @param {PoseRecord} record  with status ok
 * @returns {{names: string[], figures: Figure[]}}  height first
 */
export function readout(record) {
  const [x, y, z] = record.position_mm ?? [0, 0, 0];
  if (isBearing(record)) {
    const [right, down, ahead] = record.bearing ?? [0, 0, 1];
    const degrees = (/** @type {number} */ side) => (Math.atan2(side, ahead) * 180) / Math.PI;
    const sigma = record.bearing_sigma_deg ?? undefined;
    return {
      names: ["Range", "To the right", "Down", "Heading", "Tilt"],
      figures: [
        lengthFigure(record.range_mm ?? 0, record.range_sigma_mm ?? undefined),
        angleFigure(degrees(right), sigma), angleFigure(degrees(down), sigma), NOTHING, NOTHING,
      ],
    };
  }
  const place = record.position_sigma_mm ?? [];
  const [tiltSigma, turnSigma] = attitudeSigmas(record);
  return {
    names: ["Height", "Right of its centre", "Up the page", "Heading", "Tilt"],
    figures: [
      lengthFigure(z, place[2]), lengthFigure(x, place[0]), lengthFigure(y, place[1]),
      angleFigure(record.heading_deg ?? 0, turnSigma), angleFigure(record.tilt_deg ?? 0, tiltSigma),
    ],
  };
}

const NOTHING = { value: "–", unit: "", sigma: "" };

/** Of tilt and heading: about the camera's x and y, and about its z. @param {PoseRecord} record */
function attitudeSigmas({ attitude_sigma_deg: sigma }) {
  return sigma ? [Math.max(sigma[0], sigma[1]), sigma[2]] : [undefined, undefined];
}

/** @typedef {{kind: "none" | "found" | "lost" | "no_stream", badge: string, reason: string}} Sight */

/**
 * Whether the pad is read in a frame, and why not.
 * @param {Session | null} session
 * @param {PoseRecord | null} record  of the frame that is shown
 * @param {boolean} [isPast]  it was gone back to
 * @returns {Sight}
 */
export function sightOf(session, record, isPast = false) {
  if (!isPast) {
    if (!session) return { kind: "none", badge: "Not started", reason: "" };
    if (session.error) return { kind: "no_stream", badge: "Over", reason: sentence(session.error.message) };
    const { stream } = session;
    if (stream && stream.phase !== "open" && session.source !== "browser") {
      const badge = { connecting: "Connecting …", lost: "No stream", ended: "The stream has ended", refused: "Refused" }[stream.phase];
      return { kind: "no_stream", badge, reason: sentence(stream.detail) };
    }
    if (!record) return { kind: "none", badge: "Starting …", reason: "" };
  }
  if (!record) return { kind: "none", badge: "", reason: "" };
  if (record.status === "ok") {
    const layer = record.layer === "outline" ? "the pad’s outline" : `the ${record.layer} layer`;
    return { kind: "found", badge: "Reading", reason: isBearing(record) ? "Too far for more than range and direction." : `From ${layer}.` };
  }
  const words = [record.detail, record.advice].filter(Boolean).map((text) => sentence(/** @type {string} */ (text)));
  return { kind: "lost", badge: `Lost: ${reasonInWords(record.reason ?? "")}`, reason: words.join(" ") };
}

/** @param {string} text @returns {string} */
export function sentence(text) {
  if (!text) return "";
  return text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?…]$/.test(text) ? "" : ".");
}

/**
 * Does the print read with this camera?
 * @param {Figures} figures
 * @returns {{kind: "ok" | "warn" | "bad" | "quiet", text: string}}
 */
export function verdictOf({ recent_frames: frames, recent_read: read }) {
  const share = `${percent(read, frames)} of the frames of the last ten seconds are read`;
  if (frames < ENOUGH) return { kind: "quiet", text: "A few frames more, then it is told whether the print is read." };
  if (read >= READ * frames) return { kind: "ok", text: `Yes, the print reads with this camera: ${share}.` };
  if (read >= AT_TIMES * frames) return { kind: "warn", text: `At times: ${share}.` };
  return { kind: "bad", text: read ? `Hardly: ${share}.` : "No: none of the frames of the last ten seconds is read." };
}

/**
 * @param {Session} session
 * @returns {[string, string][]}
 */
export function factsOf({ figures, stream, source }) {
  if (!figures) return [];
  const spread = (/** @type {import("../server/liveApi.js").Spread | null} */ value) =>
    value ? `${duration(value.median)}, 95th percentile ${duration(value.p95)}` : "–";
  /** @type {[string, string][]} */
  const facts = [
    ["Read, last 10 s", `${figures.recent_read} of ${figures.recent_frames} frames`],
    ["Read, all", `${number(figures.read)} of ${number(figures.frames)} frames, ${percent(figures.read, figures.frames)}`],
    ["Frames a second", figures.frames_per_s === null ? "–" : number(figures.frames_per_s, 1)],
    [source === "browser" ? "Received to pose" : "Taken or received to pose", spread(figures.latency_ms)],
    ["Decoded to pose", spread(figures.pose_ms)],
    ["Dropped", number(figures.dropped)],
  ];
  if (stream?.size_px) facts.push(["Picture", `${stream.size_px[0]} × ${stream.size_px[1]}`]);
  if (stream && stream.connections > 1) facts.push(["Connections", number(stream.connections)]);
  if (stream?.damaged) facts.push(["Damaged frames", number(stream.damaged)]);
  return facts;
}

/**
 * The frames of the last seconds with one more.
 * @param {Shown[]} kept  the oldest first
 * @param {Shown} added
 * @returns {Shown[]}
 */
export function withShown(kept, added) {
  const all = kept.length && kept[kept.length - 1].frame.number >= added.frame.number ? [added] : [...kept, added];
  let bytes = 0;
  let first = all.length;
  while (first > 0) {
    const { frame, picture } = all[first - 1];
    bytes += picture.size;
    if (first < all.length && (added.frame.taken_s - frame.taken_s > KEPT_S || bytes > MOST_BYTES)) break;
    first -= 1;
  }
  return all.slice(first);
}

/** How long before the newest a frame was taken. @param {Shown[]} kept @param {number} place */
export function agoInWords(kept, place) {
  const { frame } = kept[place];
  const ago = kept[kept.length - 1].frame.taken_s - frame.taken_s;
  return `Frame ${number(frame.number)}, ${number(ago, 1)} s before the newest`;
}

/**
 * What is still needed; empty where nothing is.
 * @param {{pad: string, camera: string, source: string, url: string}} state
 * @returns {string}
 */
export function missingInWords({ pad, camera, source, url }) {
  if (!pad) return "Choose the pad that was printed.";
  if (source === "stream" && !url.trim()) return "Type the stream’s address.";
  return camera ? "" : "Choose the camera, or one that looks about as wide.";
}

/**
 * Why the browser gives no camera, and what to do.
 * @param {{name?: string, message?: string}} error  of getUserMedia
 * @param {{isSecure: boolean, host: string}} place
 * @returns {string}
 */
export function cameraFault({ name = "", message = "" }, { isSecure, host }) {
  if (!isSecure) {
    return `Browsers give pages a camera over https, or from this very machine, alone, and not over http from ${host}. ` +
      "Open the studio as http://localhost, or put it behind a proxy with https.";
  }
  if (name === "NotAllowedError") return "The browser was told not to give this page the camera. Allow it beside the address, then start again.";
  if (name === "NotFoundError") return "This device has no camera, or none of that kind. Plug one in, or choose another one.";
  if (name === "NotReadableError" || name === "AbortError") return "The camera is in use by another program. Close that, then start again.";
  if (name === "OverconstrainedError") return "The camera has no pictures of that size. Choose another one.";
  return `The browser gives no camera: ${message || name || "it says no more"}.`;
}

/** An address without its password, as it may be shown and kept. @param {string} address */
export const withoutPassword = (address) => address.trim().replace(/^(\w[\w+.-]*:\/\/)[^/@]*@/, "$1");

/**
 * Addresses that were used before, the newest first.
 * @param {string[]} known
 * @param {string} used
 */
export const withRecent = (known, used) =>
  [withoutPassword(used), ...known.filter((each) => each !== withoutPassword(used))].filter(Boolean).slice(0, 8);

/** @param {Session} session @returns {string} where its pictures come from, and how it is */
export function sessionInWords({ source, state, pad, figures }) {
  const from = source === "browser" ? "A browser’s camera" : source;
  const read = figures?.recent_frames ? `, ${percent(figures.recent_read, figures.recent_frames)} read` : "";
  return `${from}: ${pad.name || "pad"}, ${{ starting: "starting", running: "open", failed: "failed", idle: "ended" }[state]}${read}`;
}

/**
 * How a recording is; empty where there is none.
 * @param {import("../server/liveApi.js").Recording | null} recording
 * @returns {string}
 */
export function recordingInWords(recording) {
  if (!recording) return "";
  const { is_on: isOn, phase, detail, frames, bytes: size } = recording;
  const amount = `${framesInWords(frames)}, ${bytes(size)}`;
  if (phase === "refused" || phase === "stopped") return sentence(detail);
  if (isOn) return phase === "waiting" ? "Recording begins with the next frame at which it can." : `Recording: ${amount}.`;
  return frames ? `Recorded ${amount}.` : "Nothing was recorded: no frame came.";
}

/** @param {Session | null} session */
export const isOpen = (session) => session !== null && (session.state === "starting" || session.state === "running");
