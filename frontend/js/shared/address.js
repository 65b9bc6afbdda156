/** The page's state in the address, so that a link or a reload brings it back. */

/**
 * Replace the query; empty and null values are left out.
 * @param {Record<string, string | null>} values
 */
export function writeAddress(values) {
  const query = new URLSearchParams();
  for (const [key, value] of Object.entries(values)) {
    if (value !== null && value !== "") query.set(key, value);
  }
  const text = query.toString();
  const next = location.pathname + (text ? `?${text}` : "");
  if (next !== location.pathname + location.search) history.replaceState(null, "", next);
}

// Browsers limit how often the address may change; a drag changes it at every frame.
const LEAST_MS = 250;

/**
 * Keeps the address up to date: at once after a quiet time, else as soon as the limit allows.
 * @param {() => Record<string, string | null>} state
 * @returns {() => void} to call whenever the state may have changed
 */
export function addressKeeper(state) {
  let waiting = 0;
  let last = -Infinity;
  const write = () => {
    waiting = 0;
    last = performance.now();
    writeAddress(state());
  };
  return () => {
    waiting ||= window.setTimeout(write, Math.max(0, last + LEAST_MS - performance.now()));
  };
}

/** @returns {URLSearchParams} */
export const readAddress = () => new URLSearchParams(location.search);

/**
 * Start a download without leaving the page.
 * @param {string} url
 * @param {string} [name]  where the server does not say one
 */
export function download(url, name = "") {
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
}

// Long enough for a browser to ask where a file goes.
const KEPT_MS = 60_000;

/**
 * Save a file that the page holds.
 * @param {File} file
 */
export function saveFile(file) {
  const url = URL.createObjectURL(file);
  download(url, file.name);
  window.setTimeout(() => URL.revokeObjectURL(url), KEPT_MS);
}
