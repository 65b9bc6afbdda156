/**
 * Rules of sending a file by the tus protocol (https://tus.io/protocols/resumable-upload): how much
 * at a time, when again, what is final.
 */

const MIN_CHUNK = 256 * 1024;
const MAX_CHUNK = 32 * 1024 * 1024;
/** Short enough that the bar moves and little is sent twice, long enough to cost nothing. */
const CHUNK_MS = 1000;
const MAX_DELAY_MS = 30_000;
/** Refusals that another try may get past: conflicts, limits of rate, damaged bytes. */
const PASSING = [408, 409, 423, 425, 429, 460];
const GONE = [404, 410];

export const FIRST_CHUNK = 1024 * 1024;

/**
 * The value of `Upload-Metadata`: names with base64 of their UTF-8.
 * @param {Record<string, string>} values
 * @returns {string}
 */
export function metadata(values) {
  const base64 = (/** @type {string} */ text) =>
    btoa(String.fromCharCode(...new TextEncoder().encode(text)));
  return Object.entries(values).map(([name, value]) => `${name} ${base64(value)}`).join(",");
}

/**
 * How many bytes to send next, so that a request takes about a second.
 * @param {number} sent  bytes of the last request
 * @param {number} elapsedMs  that it took
 * @returns {number}
 */
export function nextChunkBytes(sent, elapsedMs) {
  const wanted = (sent * CHUNK_MS) / Math.max(elapsedMs, 1);
  // One quick answer is no proof of a quick line.
  return Math.round(Math.min(Math.max(Math.min(wanted, 2 * sent), MIN_CHUNK), MAX_CHUNK));
}

/**
 * How long to wait before the next try.
 * @param {number} attempt  from 1
 * @returns {number} ms
 */
export const retryDelayMs = (attempt) => Math.min(1000 * 2 ** (attempt - 1), MAX_DELAY_MS);

/**
 * What a refusal means: try again, begin anew, or give up.
 * @param {number} status  of HTTP; 0 where nothing answered
 * @returns {"again" | "anew" | "final"}
 */
export function meaningOf(status) {
  if (GONE.includes(status)) return "anew";
  return status === 0 || status >= 500 && status !== 507 || PASSING.includes(status) ? "again" : "final";
}

/**
 * By what a file is known again after a reload.
 * @param {{name: string, size: number, lastModified: number}} file
 * @param {string} folder
 * @returns {string}
 */
export const fingerprint = (file, folder) =>
  [folder, file.name, file.size, file.lastModified].join("|");
