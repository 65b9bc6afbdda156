/**
 * The form of a new flight, or of another run of one.
 *
 * @typedef {object} Range  what the fields hold
 * @property {string} first
 * @property {string} last
 * @property {string} stride
 */

/** @param {string} text @param {number} empty @returns {number} NaN where it is no whole number */
function whole(text, empty) {
  const trimmed = text.trim();
  if (!trimmed) return empty;
  return /^\d+$/.test(trimmed) ? Number(trimmed) : Number.NaN;
}

/**
 * The range as the server takes it.
 * @param {Range} range
 * @returns {{first_frame: number, end_frame: number | null, stride: number}}
 */
export function rangeValues({ first, last, stride }) {
  const end = last.trim() ? whole(last, 0) + 1 : null;
  return { first_frame: whole(first, 0), end_frame: end, stride: whole(stride, 1) };
}

/**
 * What is wrong with a range; empty where nothing is.
 * @param {Range} range
 * @returns {string}
 */
export function rangeFault(range) {
  const { first_frame: first, end_frame: end, stride } = rangeValues(range);
  if (Number.isNaN(first)) return "The first frame must be a whole number from 0.";
  if (end !== null && Number.isNaN(end)) return "The last frame must be a whole number from 0, or empty.";
  if (!(stride >= 1)) return "Every n-th frame: n must be a whole number from 1.";
  if (end !== null && end <= first) return "The last frame must not come before the first.";
  return "";
}

/**
 * What the fields hold for a flight's request.
 * @param {{first_frame?: number, end_frame?: number | null, stride?: number}} request
 * @returns {Range}
 */
export function rangeOf({ first_frame: first = 0, end_frame: end = null, stride = 1 }) {
  return {
    first: first ? String(first) : "",
    last: end === null ? "" : String(end - 1),
    stride: stride === 1 ? "" : String(stride),
  };
}

/**
 * How poses go together over time, as the server takes it.
 * @param {string} fusion  none, filter or smooth
 * @returns {{fuse: boolean, smooth: boolean}}
 */
export const fusionValues = (fusion) => ({ fuse: fusion !== "none", smooth: fusion === "smooth" });

/**
 * What the field holds for a flight's request; flights of older programs were not fused.
 * @param {{fuse?: boolean, smooth?: boolean}} request
 * @returns {string}
 */
export function fusionOf({ fuse = false, smooth = false }) {
  if (!fuse) return "none";
  return smooth ? "smooth" : "filter";
}

/**
 * What is still needed; empty where nothing is.
 * @param {{pad: string, camera: string, files: number}} state
 * @returns {string}
 */
export function missingOrder({ pad, camera, files }) {
  const needed = [files ? "" : "a video or stills", pad ? "" : "a pad", camera ? "" : "a camera"].filter(Boolean);
  if (!needed.length) return "";
  const last = needed.pop();
  return `Choose ${needed.length ? `${needed.join(", ")} and ${last}` : last}.`;
}

/**
 * Detector parameters as a sentence names them.
 * @param {Record<string, unknown>} params  by group
 */
export function paramsInWords(params) {
  const named = Object.entries(params).flatMap(([group, value]) =>
    value && typeof value === "object"
      ? Object.entries(value).map(([name, each]) => `${group}.${name} = ${each}`)
      : [`${group} = ${value}`]);
  return named.join(", ");
}

/**
 * The frames of another run, as the server takes them; nothing where they stay as they are.
 * @param {string} choice  "all", "same" or "failed"
 * @param {string} reason  empty: any
 */
export function onlyValues(choice, reason) {
  if (choice === "same") return {};
  return { only: choice === "failed" ? { status: "failed", reason: reason || null } : null };
}
