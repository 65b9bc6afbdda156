/**
 * Follows a flight while it runs: Server-Sent Events, and asking again where they do not come.
 *
 * @typedef {import("./flightsApi.js").Flight} Flight
 */

import { eventsUrl, getFlight, isOpen } from "./flightsApi.js";

const POLL_MS = 2000;

/**
 * @param {string} id
 * @param {(flight: Flight) => void} onFlight
 * @returns {{stop: () => void}}
 */
export function watchFlight(id, onFlight) {
  let timer = 0;
  let stopped = false;
  const source = new EventSource(eventsUrl(id));

  /** @param {Flight} flight */
  function take(flight) {
    if (stopped) return;
    onFlight(flight);
    if (!isOpen(flight)) stop();
  }

  async function poll() {
    try {
      take(await getFlight(id));
    } catch {
      // The next try may find the server again.
    }
    if (!stopped) timer = window.setTimeout(poll, POLL_MS);
  }

  function stop() {
    stopped = true;
    source.close();
    window.clearTimeout(timer);
  }

  source.addEventListener("flight", (event) => {
    window.clearTimeout(timer);
    timer = 0;
    take(JSON.parse(/** @type {MessageEvent} */ (event).data));
  });
  // The browser connects again by itself, or not: until it does, the page asks.
  source.addEventListener("error", () => {
    if (!stopped && !timer) timer = window.setTimeout(poll, POLL_MS);
  });
  return { stop };
}
