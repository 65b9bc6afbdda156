/**
 * Sends one file by the tus protocol: in parts, checksummed, going on after whatever broke.
 *
 * @typedef {object} Progress
 * @property {string} [url]  of the upload, known from then on
 * @property {number} [offset]  bytes that the server has
 * @property {string} [trouble]  why nothing moves; empty where it does again
 */

import { ROOT, send } from "../request.js";
import { FIRST_CHUNK, meaningOf, metadata, nextChunkBytes, retryDelayMs } from "./tusLogic.js";

const UPLOADS = `${ROOT}/uploads`;
const RESUMABLE = { "Tus-Resumable": "1.0.0" };

/**
 * @param {string} method
 * @param {string} url
 * @param {{headers?: Record<string, string>, body?: BodyInit, signal?: AbortSignal}} options
 */
const ask = (method, url, { headers, ...rest }) =>
  send(url, { method, headers: { ...RESUMABLE, ...headers }, ...rest });

/** @param {File} file @param {AbortSignal} signal @returns {Promise<string>} address of the upload */
async function create(file, signal) {
  const headers = {
    "Upload-Length": String(file.size),
    "Upload-Metadata": metadata({ filename: file.name }),
  };
  const response = await ask("POST", UPLOADS, { headers, signal });
  return new URL(response.headers.get("Location") ?? "", location.href).pathname;
}

/** @param {string} url @param {AbortSignal} signal @returns {Promise<number>} */
async function offsetOf(url, signal) {
  const response = await ask("HEAD", url, { signal });
  return Number(response.headers.get("Upload-Offset"));
}

/**
 * The header that lets the server check the bytes; browsers hash on secure addresses alone.
 * @param {ArrayBuffer} bytes
 * @returns {Promise<Record<string, string>>}
 */
async function checksum(bytes) {
  if (!window.isSecureContext) return {};
  const hash = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
  return { "Upload-Checksum": `sha256 ${btoa(String.fromCharCode(...hash))}` };
}

/**
 * @param {string} url
 * @param {number} offset
 * @param {ArrayBuffer} bytes
 * @param {AbortSignal} signal
 * @returns {Promise<number>} the new offset
 */
async function append(url, offset, bytes, signal) {
  const headers = {
    "Content-Type": "application/offset+octet-stream",
    "Upload-Offset": String(offset),
    ...(await checksum(bytes)),
  };
  const response = await ask("PATCH", url, { headers, body: bytes, signal });
  return Number(response.headers.get("Upload-Offset"));
}

/**
 * Wait, but no longer than until the browser is online again.
 * @param {number} ms
 * @param {AbortSignal} signal
 */
function pause(ms, signal) {
  return new Promise((resolve, reject) => {
    const timer = window.setTimeout(resolve, ms);
    window.addEventListener("online", resolve, { once: true });
    signal.addEventListener("abort", () => {
      window.clearTimeout(timer);
      reject(signal.reason);
    }, { once: true });
  });
}

/**
 * @param {string} url
 * @param {File} file
 * @param {number} from
 * @param {{signal: AbortSignal, onProgress: (progress: Progress) => void}} options
 */
async function sendRest(url, file, from, { signal, onProgress }) {
  let offset = from;
  let size = FIRST_CHUNK;
  onProgress({ offset, trouble: "" });
  while (offset < file.size) {
    const bytes = await file.slice(offset, offset + size).arrayBuffer();
    const begun = performance.now();
    offset = await append(url, offset, bytes, signal);
    size = nextChunkBytes(bytes.byteLength, performance.now() - begun);
    onProgress({ offset });
  }
}

/**
 * Send a file to its end, however often the connection breaks.
 * @param {File} file
 * @param {{url: string | null, signal: AbortSignal, onProgress: (progress: Progress) => void}} options
 * @returns {Promise<string>} id of the upload
 * @throws {import("../request.js").ApiError} where the server refuses it for good
 */
export async function sendFile(file, { url, signal, onProgress }) {
  let place = url;
  for (let attempt = 1; ; attempt += 1) {
    try {
      let offset = 0;
      if (place) offset = await offsetOf(place, signal);
      else {
        place = await create(file, signal);
        onProgress({ url: place });
      }
      await sendRest(place, file, offset, {
        signal,
        onProgress: (progress) => {
          if (progress.offset && progress.offset > offset) attempt = 0;
          onProgress(progress);
        },
      });
      return place.split("/").pop() ?? "";
    } catch (error) {
      const { status, message } = /** @type {import("../request.js").ApiError} */ (error);
      const meaning = signal.aborted || status === undefined ? "final" : meaningOf(status);
      if (meaning === "final" || (meaning === "anew" && !place)) throw error;
      if (meaning === "anew") place = null;
      onProgress({ trouble: message });
      await pause(retryDelayMs(Math.max(attempt, 1)), signal);
    }
  }
}

/**
 * Give an upload up; the server forgets its bytes.
 * @param {string} url
 */
export async function removeUpload(url) {
  await ask("DELETE", url, {}).catch(() => null);
}
