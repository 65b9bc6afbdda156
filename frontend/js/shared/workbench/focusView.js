/**
 * The view that is looked at, large: its tools, what is under the cursor.
 *
 * @typedef {import("./workbenchLogic.js").Place} Place
 */

import { duration } from "../formatLogic.js";
import { reasonInWords, stageAbout, stageTitle } from "../stagesLogic.js";
import { zoomAt } from "../viewportLogic.js";
import { cellAt, cellInWords } from "./cellsLogic.js";
import { mountStageView } from "./stageView.js";
import { lineAt, lineInWords, placeOf, viewportOf } from "./workbenchLogic.js";

// A line is under the cursor within so many view pixels.
const REACH_PX = 7;

/**
 * @param {HTMLElement} root
 * @param {object} events
 * @param {(place: Place | null) => void} events.onPlace
 * @param {(at: {x: number, y: number} | null) => void} events.onCursor
 * @param {(at: {x: number, y: number}) => void} events.onClick
 * @param {(change: {opacity?: number, difference?: boolean}) => void} events.onBlend
 * @param {() => void} events.onAgain
 * @param {() => void} events.onLeave  Escape
 */
export function mountFocusView(root, { onPlace, onCursor, onClick, onBlend, onAgain, onLeave }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const view = mountStageView(find("focus"), { onPlace, onCursor, onClick });
  /** @type {import("./stageView.js").ViewState | null} */
  let state = null;
  const zoom = (/** @type {number} */ factor) => {
    if (!state) return;
    const size = view.size();
    onPlace(placeOf(zoomAt(viewportOf(state.place, state.image, size), factor, { x: 0, y: 0 }), state.image, size));
  };
  find("zoom-in").addEventListener("click", () => zoom(1.5));
  find("zoom-out").addEventListener("click", () => zoom(1 / 1.5));
  find("zoom-fit").addEventListener("click", () => onPlace(null));
  find("opacity").addEventListener("input", () => onBlend({ opacity: Number(find("opacity").value) / 100 }));
  find("difference").addEventListener("change", () => onBlend({ difference: find("difference").checked }));
  find("again").addEventListener("click", onAgain);
  find("focus").addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    if (event.key === "Escape") onLeave();
  });

  /** What is told of the place under the cursor. */
  function tip() {
    if (!state?.cursor) return "";
    const at = { x: state.cursor.x - 0.5, y: state.cursor.y - 0.5 };
    if (state.cells) {
      const k = cellAt(state.cells.layer, at);
      return k === null ? "" : cellInWords(state.cells.layer, k);
    }
    const { scale } = viewportOf(state.place, state.image, view.size());
    const line = lineAt(state.picture?.marks?.lines ?? [], at, REACH_PX / scale);
    return line ? lineInWords(line) : "";
  }

  /** The line and the cell under the cursor, for the views to light up. */
  function lit() {
    if (!state?.cursor) return { litLine: null, litCell: null };
    const at = { x: state.cursor.x - 0.5, y: state.cursor.y - 0.5 };
    const { scale } = viewportOf(state.place, state.image, view.size());
    return {
      litLine: state.cells ? null : lineAt(state.picture?.marks?.lines ?? [], at, REACH_PX / scale),
      litCell: state.cells ? cellAt(state.cells.layer, at) : null,
    };
  }

  return {
    size: view.size,
    value: view.value,
    /**
     * @param {import("./stageView.js").ViewState} next
     * @param {{name: import("./workbenchLogic.js").ViewName | null,
     *   run: import("../../server/tuningApi.js").StageLook | null, isBusy: boolean, fault: string}} about
     */
    update(next, { name, run, isBusy, fault }) {
      state = next;
      const found = lit();
      view.update({ ...next, ...found });
      const title = name ? stageTitle(name.stage) : "";
      const words = `${title}${name?.channel ? `, ${name.channel}` : ""}`;
      if (find("title").textContent !== words) find("title").textContent = words;
      find("focus").setAttribute("aria-label", `${words}, large`);
      find("about").textContent = run?.failure
        ? `${reasonInWords(run.failure.reason)}: ${run.failure.detail}`
        : [stageAbout(name?.stage ?? ""), run?.elapsed_ms ? duration(run.elapsed_ms) : ""].filter(Boolean).join(" · ");
      find("about").toggleAttribute("data-failed", Boolean(run?.failure));
      find("busy").hidden = !isBusy;
      find("fault").textContent = fault;
      find("again").hidden = !fault;
      find("opacity").value = Math.round(100 * next.opacity);
      find("difference").checked = next.difference;
      const { scale } = viewportOf(next.place, next.image, view.size());
      find("zoom").textContent = `${Math.round(scale * 100)} %`;
      const text = tip();
      if (find("tip").textContent !== text) find("tip").textContent = text;
      find("tip").hidden = !text;
    },
    /** @param {string} text */
    showValue(text) {
      if (find("readout").textContent !== text) find("readout").textContent = text;
    },
  };
}
