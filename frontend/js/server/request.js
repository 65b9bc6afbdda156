/** Asks the server, and says what went wrong where it does not do what was asked. */

export const ROOT = "/api/v1";

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
 * Send a request as it is.
 * @param {string} url
 * @param {RequestInit} [init]
 * @returns {Promise<Response>} of a request that was granted
 * @throws {ApiError}
 */
export async function send(url, init = {}) {
  let response;
  try {
    response = await fetch(url, init);
  } catch (error) {
    throw init.signal?.aborted ? error : unreachable();
  }
  if (!response.ok) throw await refusal(response);
  return response;
}

/** @typedef {Record<string, string | Blob | string[]>} FormValues  a list is a field that comes again */

/** @param {FormValues} values */
export function formOf(values) {
  const form = new FormData();
  for (const [name, value] of Object.entries(values)) {
    for (const each of Array.isArray(value) ? value : [value]) form.append(name, each);
  }
  return form;
}

/**
 * Ask the REST interface, and take JSON for an answer.
 * @param {string} method
 * @param {string} path
 * @param {{json?: unknown, form?: FormValues, signal?: AbortSignal, keepalive?: boolean}} [options]
 * @returns {Promise<any>}
 */
export async function request(method, path, { json, form, signal, keepalive = false } = {}) {
  /** @type {Record<string, string>} */
  const headers = { Accept: "application/json" };
  if (json !== undefined) headers["Content-Type"] = "application/json";
  const body = json === undefined ? form && formOf(form) : JSON.stringify(json);
  const response = await send(ROOT + path, { method, signal, headers, body, keepalive });
  return response.status === 204 ? null : response.json();
}

/**
 * A path whose values are encoded: path`/pads/${id}/scale`.
 * @param {TemplateStringsArray} parts
 * @param {...(string | number)} values
 * @returns {string}
 */
export const path = (parts, ...values) =>
  String.raw({ raw: parts }, ...values.map((value) => encodeURIComponent(value)));

/**
 * What follows a path; values that say nothing are left out.
 * @param {Record<string, string | number | null | undefined>} values
 * @returns {string}
 */
export function query(values) {
  const given = Object.entries(values).filter(([, value]) => value !== null && value !== undefined && value !== "");
  const text = new URLSearchParams(given.map(([name, value]) => [name, String(value)])).toString();
  return text ? `?${text}` : "";
}

/** @returns {ApiError} where nothing answers */
function unreachable() {
  const message = "The studio does not answer. Check that it is running, then try again.";
  return new ApiError({ status: 0, code: "unreachable", message });
}

/**
 * @param {Response} response
 * @returns {Promise<ApiError>}
 */
async function refusal(response) {
  const { status } = response;
  const body = await response.json().catch(() => null);
  if (body?.error?.message) return new ApiError({ status, ...body.error });
  const message = `The studio answered with status ${status}. Try again; if it stays so, look at its log.`;
  return new ApiError({ status, code: `http_${status}`, message });
}

/** @param {unknown} error @returns {boolean} true where a newer request took its place */
export const isAbort = (error) => error instanceof DOMException && error.name === "AbortError";

/** @param {unknown} error @returns {boolean} true where the server could not answer, and the same may go well later */
export const isPassing = (error) => error instanceof ApiError && (error.status === 0 || error.status >= 500);

/**
 * The sentence of an error, for the page.
 * @param {unknown} error
 * @param {string} [file]  name of the one it is about; stands first, and once
 * @returns {string}
 */
export function messageOf(error, file = "") {
  const text = error instanceof Error ? error.message : String(error);
  const end = /[.!?]$/.test(text) ? "" : ".";
  if (file && text.startsWith(`${file}: `)) return text + end;
  return (file && `${file}: `) + text.charAt(0).toUpperCase() + text.slice(1) + end;
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

/**
 * A file under the name that the server gives it.
 * @param {string} url
 * @returns {Promise<File>}
 */
export const fetchFile = async (url) => fileOf(await send(url), url.split("/").pop() ?? "file");

/**
 * What was answered, as a file under the name that the server gives it.
 * @param {Response} response
 * @param {string} otherwise  its name where the server gives none
 * @returns {Promise<File>}
 */
export async function fileOf(response, otherwise) {
  const header = response.headers.get("Content-Disposition") ?? "";
  const given = /filename\*=UTF-8''([^;]+)/.exec(header)?.[1];
  const name = given ? decodeURIComponent(given) : otherwise;
  return new File([await response.blob()], name);
}
