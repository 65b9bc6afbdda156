/**
 * Talks to the server about pads, cameras and pictures; flightsApi.js does so about flights, and
 * tusUpload.js sends files. No other module does.
 *
 * @typedef {import("./answers.js").PadSpec} PadSpec
 * @typedef {import("./answers.js").PadFile} PadFile
 *
 * @typedef {object} PadSummary
 * @property {string} id
 * @property {string} name
 * @property {number} window
 * @property {number} levels
 * @property {[number, number]} size_mm
 * @property {{channel: string, rows: number, cols: number, cell_mm: number}[]} layers
 * @property {number | null} seed
 * @property {string | null} method
 * @property {"rotation" | "plain" | null} unique
 * @property {number | null} distance
 * @property {[number, number]} scale  measured size of the print over its nominal size
 * @property {import("./planApi.js").Crosstalk | null} crosstalk  by which frames are un-mixed
 * @property {string} created_at
 *
 * @typedef {object} CameraSummary
 * @property {string} id
 * @property {string} name
 * @property {number} width
 * @property {number} height
 * @property {number} focal_px
 * @property {string} model
 * @property {number[]} distortion
 * @property {boolean} nominal
 * @property {string} [note]
 */

const ROOT = "/api/v1";

/** What the server refuses, or that it does not answer. */
export class ApiError extends Error {
  /** @param {{status: number, code: string, message: string, detail?: Record<string, unknown>}} fault */
  constructor({ status, code, message, detail = {} }) {
    super(message);
    this.name = "ApiError";
    this.status = status;
    this.code = code;
    this.detail = detail;
  }
}

/**
 * @param {string} method
 * @param {string} path
 * @param {{json?: unknown, form?: Record<string, string | Blob>, signal?: AbortSignal}} [options]
 * @returns {Promise<any>}
 */
export async function request(method, path, { json, form, signal } = {}) {
  /** @type {RequestInit} */
  const init = { method, signal, headers: { Accept: "application/json" } };
  if (json !== undefined) {
    init.headers = { ...init.headers, "Content-Type": "application/json" };
    init.body = JSON.stringify(json);
  } else if (form) {
    const body = new FormData();
    for (const [name, value] of Object.entries(form)) body.append(name, value);
    init.body = body;
  }
  let response;
  try {
    response = await fetch(ROOT + path, init);
  } catch (error) {
    if (signal?.aborted) throw error;
    throw unreachable();
  }
  if (!response.ok) throw await refusal(response);
  return response.status === 204 ? null : response.json();
}

/** @returns {ApiError} where nothing answers */
export function unreachable() {
  const message = "The studio does not answer. Check that it is running, then try again.";
  return new ApiError({ status: 0, code: "unreachable", message });
}

/**
 * @param {Response} response
 * @returns {Promise<ApiError>}
 */
export async function refusal(response) {
  const { status } = response;
  const body = await response.json().catch(() => null);
  if (body?.error?.message) return new ApiError({ status, ...body.error });
  const message = `The studio answered with status ${status}. Try again; if it stays so, look at its log.`;
  return new ApiError({ status, code: `http_${status}`, message });
}

/** @param {unknown} error @returns {boolean} true where a newer request took its place */
export const isAbort = (error) => error instanceof DOMException && error.name === "AbortError";

/**
 * The sentence of an error, for the page.
 * @param {unknown} error
 * @returns {string}
 */
export function messageOf(error) {
  const text = error instanceof Error ? error.message : String(error);
  return text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");
}

/**
 * The fields of a request that the server refused, each with its sentence.
 * @param {unknown} error
 * @returns {Record<string, string>}
 */
export function fieldFaults(error) {
  const fields = error instanceof ApiError ? error.detail.fields : null;
  if (!Array.isArray(fields)) return {};
  return Object.fromEntries(fields.map(({ place, message }) => [place, messageOf(message)]));
}

// Pads

/**
 * @param {PadSpec} spec
 * @param {AbortSignal} signal
 * @returns {Promise<{pad: PadFile, verification: import("./answers.js").Verification}>}
 */
export const previewPad = (spec, signal) =>
  request("POST", "/pads/preview", { json: spec, signal });

/** @param {PadSpec} spec @returns {Promise<PadSummary>} */
export const createPad = (spec) => request("POST", "/pads", { json: spec });

/**
 * Import a pad file, or a table or picture of a field with what it does not say itself.
 * @param {File} file
 * @param {Record<string, string>} [sizes]
 * @returns {Promise<PadSummary>}
 */
export const importPad = (file, sizes = {}) =>
  request("POST", "/pads/import", { form: { ...sizes, file } });

/** @returns {Promise<{items: PadSummary[], total: number}>} */
export const listPads = () => request("GET", "/pads?limit=1000");

/** @param {string} id @returns {Promise<PadSummary & {pad: PadFile}>} */
export const getPad = (id) => request("GET", `/pads/${encodeURIComponent(id)}`);

/** @param {string} id */
export const deletePad = (id) => request("DELETE", `/pads/${encodeURIComponent(id)}`);

/**
 * Address of a pad in a file's form.
 * @param {string} id
 * @param {string} form
 * @param {string} [query]  how it is printed
 * @returns {string}
 */
export const padFileUrl = (id, form, query = "") =>
  `${ROOT}/pads/${encodeURIComponent(id)}/files/pad.${form}${query}`;

// Cameras

/** @returns {Promise<{presets: CameraSummary[], stored: CameraSummary[]}>} */
export async function listCameras() {
  const [presets, stored] = await Promise.all([
    request("GET", "/cameras/presets"),
    request("GET", "/cameras"),
  ]);
  return { presets: presets.items, stored: stored.items };
}

/** @param {File} file @returns {Promise<CameraSummary>} */
export const importCamera = (file) => request("POST", "/cameras", { form: { file } });

// The tour's sample

/**
 * @typedef {{pad: string, camera: string, pictures: string[]}} Sample  addresses of files
 *
 * @returns {Promise<Sample>}
 */
export const getSample = () => request("GET", "/samples");

/**
 * @param {string} url
 * @returns {Promise<File>}
 */
export async function fetchFile(url) {
  const response = await fetch(url);
  if (!response.ok) throw await refusal(response);
  const header = response.headers.get("Content-Disposition") ?? "";
  const given = /filename\*=UTF-8''([^;]+)/.exec(header)?.[1];
  const name = given ? decodeURIComponent(given) : url.split("/").pop();
  return new File([await response.blob()], name ?? "file");
}

// Detection

/**
 * @typedef {import("./answers.js").DetectAnswer} DetectAnswer
 *
 * @param {{image: File, pad: string, camera: string, method: string}} job
 * @param {AbortSignal} signal
 * @returns {Promise<DetectAnswer>}
 */
export const detect = ({ image, pad, camera, method }, signal) =>
  request("POST", "/detect", { form: { image, pad, camera, method, trace: "true" }, signal });

/** @param {string} traceId @returns {Promise<DetectAnswer>} */
export const getDetection = (traceId) =>
  request("GET", `/detect/${encodeURIComponent(traceId)}`);
