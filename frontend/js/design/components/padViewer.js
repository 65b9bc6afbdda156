/**
 * The large view of a pad: zoom, pan, the cell under the pointer in figures, the layers' strip.
 *
 * @typedef {import("../padLogic.js").PadView} PadView
 * @typedef {import("../../shared/viewportLogic.js").Viewport} Viewport
 *
 * @typedef {object} PadViewerState
 * @property {PadView | null} pad
 * @property {string} view  "print" or a channel
 * @property {Viewport | null} viewport  null: the whole page
 * @property {boolean} busy
 * @property {string} message  shown where there is no pad
 * @property {{channel: string, windows: {row: number, col: number}[]} | null} pair  two windows to
 *   show, nearly alike
 */

import { compact } from "../../shared/formatLogic.js";
import { cellAt, layersOfView, windowRound } from "../padLogic.js";
import { placeInWords } from "../placeLogic.js";
import { clamp, fit, scaleBar, toSheet, zoomAt } from "../../shared/viewportLogic.js";
import { paintPad } from "./padPainter.js";
import { fromMiddle, makeZoomable } from "../../shared/components/zoomable.js";

const MIDDLE = { x: 0, y: 0 };
// The share of the view's shorter side that "one cell" fills.
const CELL_SHARE = 0.5;

/**
 * @param {HTMLElement} root
 * @param {{onViewport: (viewport: Viewport | null) => void}} events
 */
export function mountPadViewer(root, { onViewport }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  const canvas = /** @type {HTMLCanvasElement} */ (find("canvas"));
  /** @type {PadViewerState} */
  let state = { pad: null, view: "print", viewport: null, busy: false, message: "", pair: null };
  /** @type {{x: number, y: number} | null} */
  let pointer = null;

  const viewSize = () => ({ width: canvas.clientWidth, height: canvas.clientHeight });
  const sheet = (/** @type {PadView} */ pad) => ({
    width: pad.widthMm + 2 * pad.quietMm,
    height: pad.heightMm + 2 * pad.quietMm,
  });
  const finest = () => (state.pad ? (layersOfView(state.pad, state.view)[0] ?? null) : null);
  const current = () => {
    if (!state.pad) return null;
    return state.viewport ?? fit(sheet(state.pad), viewSize());
  };
  const change = (/** @type {Viewport} */ viewport) => {
    const layer = finest();
    if (!state.pad || !layer) return;
    const most = Math.min(canvas.clientWidth, canvas.clientHeight) / layer.cellMm;
    onViewport(clamp(viewport, sheet(state.pad), viewSize(), most));
  };
  const zoom = (/** @type {number} */ factor) => {
    const viewport = current();
    if (viewport) change(zoomAt(viewport, factor, MIDDLE));
  };

  function zoomToCell() {
    const layer = finest();
    const viewport = current();
    if (!state.pad || !layer || !viewport) return;
    const quiet = state.pad.quietMm;
    const centre = (/** @type {number} */ at, /** @type {number} */ count) => {
      const cell = Math.max(0, Math.min(Math.floor((at - quiet) / layer.cellMm), count - 1));
      return quiet + (cell + 0.5) * layer.cellMm;
    };
    const side = Math.min(canvas.clientWidth, canvas.clientHeight);
    change({
      x: centre(viewport.x, layer.cols),
      y: centre(viewport.y, layer.rows),
      scale: (CELL_SHARE * side) / layer.cellMm,
    });
  }

  function mark() {
    const viewport = current();
    const layer = finest();
    // Without a pointer the view's middle is read, so that the keyboard reaches every cell.
    const at = pointer ?? (document.activeElement === canvas ? MIDDLE : null);
    if (!state.pad || !viewport || !layer || !at) return null;
    const place = toSheet(viewport, at);
    const cell = cellAt(layer, place.x, place.y, state.pad);
    return cell && { cell, place, window: windowRound(cell, state.pad.window) };
  }

  function paint() {
    const viewport = current();
    find("tools").toggleAttribute("inert", !state.pad);
    if (!state.pad || !viewport || !canvas.clientWidth) return;
    const found = mark();
    const outline = found && { ...found.cell, window: found.window };
    paintPad(canvas, state.pad, state.view, viewport, outline, pairMark(state));
    find("readout").textContent = found
      ? placeInWords(state.pad, state.view, found.place, found.cell, found.window)
      : "Point at a cell, or focus the picture and use the arrow keys.";
    const relative = viewport.scale / fit(sheet(state.pad), viewSize()).scale;
    find("zoom").textContent = `${Math.round(relative * 100)} %`;
    const bar = scaleBar(viewport.scale, 120);
    find("scale").style.width = `${bar.pixels}px`;
    find("scale-text").textContent = `${compact(bar.units)} mm`;
    // A finger on the whole pad scrolls the page; zoomed in, it moves the pad.
    canvas.style.touchAction = state.viewport ? "none" : "pan-y";
  }

  makeZoomable(canvas, { current, change, reset: () => onViewport(null) });
  canvas.addEventListener("pointermove", (event) => {
    pointer = fromMiddle(canvas, event);
    requestAnimationFrame(paint);
  });
  canvas.addEventListener("pointerleave", () => {
    pointer = null;
    paint();
  });
  canvas.addEventListener("focus", paint);
  canvas.addEventListener("blur", paint);
  find("zoom-in").addEventListener("click", () => zoom(1.5));
  find("zoom-out").addEventListener("click", () => zoom(1 / 1.5));
  find("zoom-fit").addEventListener("click", () => onViewport(null));
  find("zoom-cell").addEventListener("click", zoomToCell);
  new ResizeObserver(paint).observe(canvas);

  return {
    /** @param {PadViewerState} next */
    update(next) {
      state = next;
      root.toggleAttribute("data-busy", next.busy);
      canvas.hidden = !next.pad;
      find("message").textContent = next.pad ? "" : next.message;
      find("busy").hidden = !next.busy;
      paint();
    },
  };
}

/**
 * The two windows on the layer that they are of, where that is shown.
 * @param {PadViewerState} state
 * @returns {import("./padPainter.js").PairMark | null}
 */
function pairMark({ pad, view, pair }) {
  if (!pad || !pair) return null;
  const layer = layersOfView(pad, view).find((each) => each.channel === pair.channel);
  return layer ? { layer, windows: pair.windows } : null;
}
