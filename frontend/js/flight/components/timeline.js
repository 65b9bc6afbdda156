/**
 * The timeline of a flight: heights above, outcomes below, the frame in between.
 *
 * @typedef {import("../timelineLogic.js").Timeline} Timeline
 * @typedef {import("../timelineLogic.js").Part} Part
 *
 * @typedef {object} TimelineState
 * @property {Timeline | null} timeline
 * @property {Timeline | null} other  of a second run
 * @property {(Part & {stride: number}) | null} whole
 * @property {Part | null} part  that is shown; null is the whole
 * @property {number | null} frame
 * @property {number | null} timeS  of the frame
 */

import { clock, number } from "../../shared/formatLogic.js";
import { mountPlot } from "../../shared/components/plot.js";
import { kindsShown, timelineChart } from "../timelineChartLogic.js";
import { columnInWords, columnOf, frameAt, placeOf, timelineInWords, zoomPart } from "../timelineLogic.js";

const WHEEL_RATE = 0.0018;

/**
 * @param {HTMLElement} root
 * @param {{onSeek: (frame: number) => void, onPart: (part: Part | null) => void}} events
 */
export function mountTimeline(root, { onSeek, onPart }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  const picture = find("picture");
  const plot = mountPlot(picture);
  const track = find("track");
  /** @type {TimelineState} */
  let state = { timeline: null, other: null, whole: null, part: null, frame: null, timeS: null };
  /** @type {unknown[]} */
  let drawn = [];
  const part = () => state.part ?? state.whole;

  function draw() {
    const { timeline, other } = state;
    const shown = part();
    const wanted = [timeline, other, shown?.first, shown?.last];
    if (!timeline || !shown || wanted.every((each, at) => each === drawn[at])) return;
    drawn = wanted;
    const kinds = kindsShown(other ? [timeline, other] : [timeline]);
    for (const item of /** @type {NodeListOf<HTMLElement>} */ (root.querySelectorAll("[data-kind]"))) {
      item.hidden = !kinds.includes(item.dataset.kind ?? "");
    }
    plot.show((colour, width, height) => timelineChart({ timeline, other, part: shown }, colour, width, height));
  }

  function moveCursor() {
    const shown = part();
    const place = shown && state.frame !== null ? placeOf(shown, state.frame) : -1;
    find("cursor").hidden = !(place >= 0 && place <= 1);
    find("cursor").style.left = `${100 * place}%`;
  }

  /** @param {{clientX: number}} event @returns {number} 0 … 1 */
  function placeUnder(event) {
    const box = track.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
  }

  /** @param {PointerEvent} event */
  function seek(event) {
    const shown = part();
    if (shown && state.whole) onSeek(frameAt(shown, placeUnder(event), state.whole));
  }

  /** @param {number} factor @param {number} place */
  function zoom(factor, place) {
    const shown = part();
    if (shown && state.whole) onPart(zoomPart(shown, factor, place, state.whole));
  }

  track.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    track.setPointerCapture(event.pointerId);
    seek(event);
  });
  track.addEventListener("pointermove", (event) => {
    if (track.hasPointerCapture(event.pointerId)) seek(event);
    const shown = part();
    if (!shown || !state.whole || !state.timeline) return;
    const frame = frameAt(shown, placeUnder(event), state.whole);
    find("hint").textContent = columnInWords(columnOf(state.timeline, frame), frame);
  });
  track.addEventListener("pointerleave", () => {
    find("hint").textContent = "";
  });
  track.addEventListener("wheel", (event) => {
    // A wheel that only passes over the timeline scrolls the page.
    if (!event.ctrlKey && document.activeElement !== track) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * WHEEL_RATE), placeUnder(event));
  }, { passive: false });
  track.addEventListener("keydown", (event) => {
    const factor = { "+": 2, "=": 2, "-": 0.5, _: 0.5 }[event.key];
    if (factor && !event.ctrlKey && !event.metaKey) zoom(factor, cursorPlace());
  });

  function cursorPlace() {
    const shown = part();
    if (!shown || state.frame === null) return 0.5;
    return Math.min(Math.max((state.frame - shown.first) / (shown.last - shown.first + 1), 0), 1);
  }

  return {
    /** Columns that can be told apart. */
    columns: () => Math.max(100, Math.min(track.clientWidth, 2000)),
    /** @param {TimelineState} next */
    update(next) {
      state = next;
      const { timeline, whole, frame, timeS } = state;
      find("empty").hidden = Boolean(timeline?.columns.length);
      find("other").hidden = !state.other;
      track.setAttribute("aria-valuemin", String(whole?.first ?? 0));
      track.setAttribute("aria-valuemax", String(whole?.last ?? 0));
      track.setAttribute("aria-valuenow", String(frame ?? 0));
      const time = timeS === null ? "" : `, ${clock(timeS)}`;
      track.setAttribute("aria-valuetext", frame === null ? "none" : `${number(frame)}${time}`);
      picture.setAttribute("aria-label", timeline ? timelineInWords(timeline) : "");
      draw();
      moveCursor();
    },
  };
}
