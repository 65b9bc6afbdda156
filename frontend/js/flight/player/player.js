/**
 * Plays a flight at its own rate: each moment shows the frame whose time it is.
 *
 * @typedef {import("./proxyLogic.js").Whole} Whole
 */

import { frameAfter } from "./proxyLogic.js";

/** Play that lags so far goes on from where it is. */
const PATIENCE_MS = 150;

/**
 * @param {{whole: () => Whole | null, frame: () => number | null, loop: () => {from: number, to: number} | null,
 *   timeOf: (frame: number) => number | null | undefined, isReady: (frame: number) => boolean,
 *   onFrame: (frame: number) => void, onWant: (frame: number) => void, onEnd: () => void}} page
 */
export function makePlayer({ whole, frame, loop, timeOf, isReady, onFrame, onWant, onEnd }) {
  let running = 0;
  let from = 0;
  let startedMs = 0;
  let shown = -1;
  let waitedMs = 0;

  /** Go on from a frame, now. @param {number} at */
  function begin(at) {
    from = at;
    shown = at;
    startedMs = performance.now();
  }

  /**
   * A slow machine leaves frames out, but not the last one.
   * @param {number} last
   * @param {number} current
   * @param {number} nowMs
   */
  function end(last, current, nowMs) {
    if (current < last && !isReady(last)) {
      onWant(last);
      waitedMs ||= nowMs;
      if (nowMs - waitedMs <= PATIENCE_MS) return;
    }
    if (current < last) {
      shown = last;
      onFrame(last);
    }
    waitedMs = 0;
    onEnd();
  }

  /** @param {number} nowMs */
  function tick(nowMs) {
    running = requestAnimationFrame(tick);
    const all = whole();
    const current = frame();
    if (!all || current === null) return;
    // The user jumped meanwhile.
    if (current !== shown) begin(current);
    const at = { frame: from, elapsed_s: Math.max(0, nowMs - startedMs) / 1000, loop: loop() };
    const next = frameAfter(at, all, timeOf);
    if (next.ended) {
      end(all.last, current, nowMs);
      return;
    }
    if (next.frame === current && !next.wrapped) {
      // Play waits for pictures that are on their way; after the last frame there are none.
      const isLast = current >= (loop()?.to ?? all.last);
      if (!isLast && timeOf(current + all.stride) === undefined) begin(current);
      return;
    }
    // The last one that is there; where none is, play waits for it rather than leave it out.
    let ready = next.frame;
    while (!next.wrapped && ready > current && !isReady(ready)) ready -= all.stride;
    if (!isReady(ready) || ready === current) {
      onWant(next.frame);
      waitedMs ||= nowMs;
      if (nowMs - waitedMs > PATIENCE_MS) begin(current);
      return;
    }
    waitedMs = 0;
    if (next.wrapped) begin(ready);
    shown = ready;
    onFrame(ready);
  }

  return {
    /** @param {boolean} playing */
    update(playing) {
      if (playing === Boolean(running)) return;
      if (!playing) {
        cancelAnimationFrame(running);
        running = 0;
        return;
      }
      const all = whole();
      let at = frame() ?? 0;
      const range = loop();
      const ends = range ?? (all && { from: all.first, to: all.last });
      if (ends && (at >= ends.to || at < ends.from)) {
        at = ends.from;
        onFrame(at);
      }
      begin(at);
      running = requestAnimationFrame(tick);
    },
  };
}
