/**
 * The picture with the pad's lattice over it, whether it is read, and the figures that are read from afar.
 *
 * @typedef {import("../liveLogic.js").Shown} Shown
 */

import { paintMarks } from "../../shared/workbench/marksPainter.js";
import { readout, sightOf } from "../liveLogic.js";

const FIGURES = ["main", "x", "y", "heading", "tilt"];

/** @param {HTMLElement} root */
export function mountLiveView(root) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const canvas = /** @type {HTMLCanvasElement} */ (find("canvas"));
  /** @type {Shown | null} */
  let painted = null;
  let hasFigures = false;

  /** @param {string} name @param {string} text */
  function write(name, text) {
    const element = find(name);
    if (element.textContent !== text) element.textContent = text;
  }

  /** @param {Shown} shown */
  async function paint(shown) {
    painted = shown;
    const bitmap = await createImageBitmap(shown.picture);
    if (painted === shown) {
      const scale = Math.min(1, 1600 / bitmap.width);
      [canvas.width, canvas.height] = [Math.round(bitmap.width * scale), Math.round(bitmap.height * scale)];
      const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
      context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
      paintMarks(context, shown.frame.marks, (x, y) => [(x + 0.5) * scale, (y + 0.5) * scale], scale, null);
      canvas.dataset.frame = String(shown.frame.number);
    }
    bitmap.close();
  }

  return {
    /**
     * @param {{session: import("../../server/liveApi.js").Session | null, shown: Shown | null, isPast: boolean, isNominal: boolean}} state
     */
    update({ session, shown, isPast, isNominal }) {
      const record = shown?.frame.record ?? null;
      const sight = sightOf(session, record, isPast);
      root.dataset.sight = sight.kind;
      root.dataset.past = String(isPast);
      write("badge", sight.badge);
      write("reason", sight.reason);
      if (shown && shown !== painted) void paint(shown);
      find("empty").hidden = shown !== null;
      const label = shown ? `Frame ${shown.frame.number}: ${sight.badge}` : "No picture yet";
      if (canvas.getAttribute("aria-label") !== label) canvas.setAttribute("aria-label", label);
      // The last figures stay while the pad is lost, greyed, so that they do not flicker.
      if (record?.status === "ok") {
        const { names, figures } = readout(record);
        FIGURES.forEach((name, at) => {
          write(`${name}-name`, names[at]);
          write(name, figures[at].value);
          write(`${name}-unit`, figures[at].unit);
          write(`${name}-sigma`, figures[at].sigma);
        });
        hasFigures = true;
      }
      find("readout").hidden = !hasFigures;
      find("nominal").hidden = !(isNominal && hasFigures);
    },
  };
}
