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
