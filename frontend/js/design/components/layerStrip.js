/**
 * Small live pictures of the print and of each layer; choosing one shows it large.
 *
 * @typedef {import("../padLogic.js").PadView} PadView
 */

import { size } from "../../shared/formatLogic.js";
import { fit } from "../../shared/viewportLogic.js";
import { paintPad } from "./padPainter.js";

const THUMB_BORDER_PX = 4;

/**
 * @param {HTMLElement} root  holds a label with a radio button and a canvas for each view
 * @param {{onView: (view: string) => void}} events
 */
export function mountLayerStrip(root, { onView }) {
  const labels = [...root.querySelectorAll("label")];
  /** @type {PadView | null} */
  let painted = null;
  root.addEventListener("change", (event) => {
    onView(/** @type {HTMLInputElement} */ (event.target).value);
  });

  /** @param {PadView} pad @param {HTMLLabelElement} label @param {string} view */
  function paint(pad, label, view) {
    const canvas = /** @type {HTMLCanvasElement} */ (label.querySelector("canvas"));
    const margin = 2 * pad.quietMm;
    const sheet = { width: pad.widthMm + margin, height: pad.heightMm + margin };
    const place = { width: canvas.clientWidth, height: canvas.clientHeight };
    if (place.width) paintPad(canvas, pad, view, fit(sheet, place, THUMB_BORDER_PX));
  }

  function paintAll() {
    for (const label of labels) {
      const input = /** @type {HTMLInputElement} */ (label.querySelector("input"));
      if (painted && !label.hidden) paint(painted, label, input.value);
    }
  }
  new ResizeObserver(paintAll).observe(root);

  return {
    /** @param {{pad: PadView | null, view: string}} state */
    update({ pad, view }) {
      root.hidden = !pad;
      for (const label of labels) {
        const input = /** @type {HTMLInputElement} */ (label.querySelector("input"));
        const layer = pad?.layers.find((candidate) => candidate.channel === input.value);
        label.hidden = input.value !== "print" && !layer;
        input.checked = input.value === view;
        const note = /** @type {HTMLElement} */ (label.querySelector("[data-ref=note]"));
        if (layer) note.textContent = `${layer.cols} × ${layer.rows} cells`;
        else if (pad) note.textContent = size(pad.widthMm, pad.heightMm);
      }
      if (pad !== painted) {
        painted = pad;
        paintAll();
      }
    },
  };
}
