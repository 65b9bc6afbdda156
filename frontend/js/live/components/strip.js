/**
 * The last ten seconds to scrub back, and what opens one of their frames.
 *
 * @typedef {import("../liveLogic.js").Shown} Shown
 */

import { agoInWords } from "../liveLogic.js";

/**
 * @param {HTMLElement} root
 * @param {{onPlace: (place: number | null) => void, onStages: () => void}} events  null: the newest
 */
export function mountStrip(root, { onPlace, onStages }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const place = /** @type {HTMLInputElement} */ (find("place"));
  const marks = /** @type {HTMLCanvasElement} */ (find("marks"));
  place.addEventListener("input", () => onPlace(Number(place.value)));
  find("live").addEventListener("click", () => {
    onPlace(null);
    place.focus();
  });
  find("stages").addEventListener("click", onStages);

  /** Which frames were read, along the slider. @param {Shown[]} kept */
  function paint(kept) {
    const { color, outlineColor } = getComputedStyle(marks);
    const context = /** @type {CanvasRenderingContext2D} */ (marks.getContext("2d"));
    context.clearRect(0, 0, marks.width, marks.height);
    const step = marks.width / kept.length;
    kept.forEach(({ frame }, k) => {
      context.fillStyle = frame.record.status === "ok" ? color : outlineColor;
      // Failures stand taller, too, so that colour is not all that tells them.
      const height = frame.record.status === "ok" ? 4 : marks.height;
      context.fillRect(k * step, marks.height - height, Math.max(step - 0.4, 0.6), height);
    });
  }

  return {
    /** @param {{kept: Shown[], place: number | null, isOpening: boolean}} state */
    update({ kept, place: at, isOpening }) {
      root.hidden = kept.length === 0;
      if (!kept.length) return;
      const last = kept.length - 1;
      const value = String(at ?? last);
      if (place.max !== String(last)) place.max = String(last);
      if (place.value !== value) place.value = value;
      const words = at === null ? "" : agoInWords(kept, at);
      place.setAttribute("aria-valuetext", words || "the newest frame");
      if (find("words").textContent !== words) find("words").textContent = words;
      find("live").hidden = at === null;
      find("stages").disabled = isOpening;
      paint(kept);
    },
  };
}
