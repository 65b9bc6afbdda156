/**
 * Follows what changes on the server: Server-Sent Events, and asking again where they do not come.
 */

const POLL_MS = 2000;

/**
 * @template T
 * @param {string} address  of the events
 * @param {string} name  of the event that holds all of it
 * @param {{ask: () => Promise<T>, take: (found: T) => void, isOver: (found: T) => boolean, onFault?: (error: unknown) => void}} how
 * @returns {{stop: () => void}}
 */
export function watchEvents(address, name, { ask, take, isOver, onFault }) {
  let timer = 0;
  let stopped = false;
  const source = new EventSource(address);

  /** @param {T} found */
  function show(found) {
    if (stopped) return;
    take(found);
    if (isOver(found)) stop();
  }

  async function poll() {
    try {
      show(await ask());
    } catch (error) {
      // The next try may find the server again.
      if (!stopped) onFault?.(error);
    }
    if (!stopped) timer = window.setTimeout(poll, POLL_MS);
  }

  function stop() {
    stopped = true;
    source.close();
    window.clearTimeout(timer);
  }

  source.addEventListener(name, (event) => {
    window.clearTimeout(timer);
    timer = 0;
    show(JSON.parse(/** @type {MessageEvent} */ (event).data));
  });
  // The browser connects again by itself, or not: until it does, the page asks.
  source.addEventListener("error", () => {
    if (!stopped && !timer) timer = window.setTimeout(poll, POLL_MS);
  });
  return { stop };
}
