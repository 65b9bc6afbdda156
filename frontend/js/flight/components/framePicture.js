/**
 * The frame that is looked at, the largest thing on the page, with the pad drawn over it.
 *
 * @typedef {import("../../server/flightsApi.js").OutlineLine} OutlineLine
 *
 * @typedef {import("./framePainter.js").Picture} Picture
 *
 * @typedef {object} FrameState
 * @property {number | null} frame
 * @property {Picture | null} picture  of this frame; null while it is on the way
 * @property {OutlineLine[]} lines
 * @property {boolean} outlined  the pad is drawn
 * @property {boolean} lost  the file has no picture of this frame
 * @property {boolean} awaited  the analysis has not come to it
 * @property {{done: number, total: number} | null} making  how far its picture is
 * @property {string} fault  why it does not come
 */

import { number } from "../../shared/formatLogic.js";
import { paintFrame } from "./framePainter.js";

/** Shorter waits show nothing: what comes at once needs no word. */
const BUSY_MS = 300;
const PROGRESS_MS = 1000;

/**
 * @param {HTMLElement} root
 * @param {{onEnlarge: () => void, onOutlined: (outlined: boolean) => void, onAgain: () => void}} events
 */
export function mountFramePicture(root, { onEnlarge, onOutlined, onAgain }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const canvas = /** @type {HTMLCanvasElement} */ (find("canvas"));
  /** @type {FrameState | null} */
  let state = null;
  /** @type {Picture | null} */
  let last = null;
  let waitingMs = 0;
  let timer = 0;
  let painted = "";
  find("enlarge").addEventListener("click", onEnlarge);
  find("again").addEventListener("click", onAgain);
  find("outlined").addEventListener("change", () => onOutlined(find("outlined").checked));
  new ResizeObserver(() => paint()).observe(find("stage"));

  function paint() {
    const shown = state?.picture ?? last;
    if (!state || !shown) return;
    paintFrame(canvas, find("stage").clientWidth, shown, state.picture && state.outlined ? state.lines : []);
  }

  /** Says that work goes on, and after a while how far it is. */
  function showWait() {
    window.clearTimeout(timer);
    const waited = waitingMs ? performance.now() - waitingMs : 0;
    const isBusy = Boolean(waitingMs) && waited >= BUSY_MS;
    find("busy").hidden = !isBusy;
    root.toggleAttribute("data-waiting", isBusy);
    const making = state?.making;
    const isLong = isBusy && waited >= PROGRESS_MS;
    find("progress").hidden = !(isLong && making);
    if (making) [find("progress").max, find("progress").value] = [making.total, making.done];
    find("words").textContent = making && isLong
      ? `Making pictures: ${number(making.done)} of ${number(making.total)} frames`
      : state?.awaited ? "Waiting for the analysis …" : "Fetching the picture …";
    if (waitingMs) timer = window.setTimeout(showWait, isBusy ? 250 : BUSY_MS - waited);
  }

  return {
    /** @param {FrameState} next */
    update(next) {
      state = next;
      const { frame, picture, lost, fault, outlined } = next;
      root.hidden = frame === null;
      if (frame === null) return;
      const isWaiting = !picture && !lost && !fault;
      if (!isWaiting) waitingMs = 0;
      else waitingMs ||= performance.now();
      showWait();
      find("note").textContent = lost ? "The file has no picture of this frame." : fault;
      find("fault").hidden = !lost && !fault;
      find("again").hidden = !fault;
      find("outlined").checked = outlined;
      canvas.setAttribute("aria-label", `Frame ${number(frame)}${outlined ? " with the pad where its pose says that it lies" : ""}`);
      canvas.dataset.frame = picture ? String(frame) : "";
      canvas.dataset.sharp = String(picture?.scale === 1 || picture?.image instanceof HTMLImageElement);
      if (picture) last = picture;
      const key = [frame, picture?.image.width, outlined, next.lines.length, lost].join();
      if (key === painted && !isWaiting) return;
      painted = key;
      canvas.hidden = lost || !last;
      paint();
    },
  };
}
