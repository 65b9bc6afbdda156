/**
 * Deletes after a while in which it can be undone; what still waits when the page closes is deleted then.
 *
 * @typedef {import("./homeLogic.js").Card} Card
 */

import { remove } from "../server/libraryApi.js";

const UNDO_MS = 8000;

/** @param {{onChange: (waiting: Card[]) => void, onFault: (card: Card, error: unknown) => void}} events */
export function makeRemovals({ onChange, onFault }) {
  /** @type {Map<string, {card: Card, timer: number}>} */
  const waiting = new Map();
  const tell = () => onChange([...waiting.values()].map(({ card }) => card));

  /** @param {string} key */
  async function carryOut(key) {
    const found = waiting.get(key);
    if (!found) return;
    window.clearTimeout(found.timer);
    try {
      await remove(found.card.kind, found.card.id);
    } catch (error) {
      onFault(found.card, error);
    }
    waiting.delete(key);
    tell();
  }
  window.addEventListener("pagehide", () => [...waiting.keys()].forEach((key) => void carryOut(key)));

  return {
    /** @param {Card} card */
    add(card) {
      waiting.set(card.key, { card, timer: window.setTimeout(() => void carryOut(card.key), UNDO_MS) });
      tell();
    },
    /** Keep the last one after all. */
    undo() {
      const last = [...waiting.entries()].at(-1);
      if (!last) return;
      window.clearTimeout(last[1].timer);
      waiting.delete(last[0]);
      tell();
    },
  };
}
