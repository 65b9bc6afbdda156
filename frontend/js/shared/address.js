/** What outlives a reload: the page's state in the address, which a link has too, and drafts. */

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
 * Keeps what is being typed into fields, so that a reload does not lose it; each tab has its own.
 *
 * @param {string} name  of the draft, on this page
 * @param {() => (HTMLInputElement | HTMLSelectElement)[]} fields
 * @param {() => string} [over]  what it is typed over; what is typed over something else is stale
 */
export function makeDraft(name, fields, over = () => "") {
  const key = `draft ${location.pathname} ${name}`;
  for (const field of fields()) {
    field.addEventListener("input", () => write(JSON.stringify([over(), ...fields().map(({ value }) => value)])));
  }

  /** @param {string} text */
  function write(text) {
    try {
      if (text) sessionStorage.setItem(key, text);
      else sessionStorage.removeItem(key);
    } catch {
      // A browser that keeps nothing forgets drafts, too.
    }
  }

  return {
    /** Texts in the order of the fields; null where nothing was typed. @returns {string[] | null} */
    read() {
      try {
        const [typedOver, ...texts] = JSON.parse(sessionStorage.getItem(key) ?? "[]");
        return typedOver === over() && texts.length === fields().length ? texts.map(String) : null;
      } catch {
        return null;
      }
    },
    /** What was typed has been done, or is to be no more. */
    forget: () => write(""),
  };
}

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
