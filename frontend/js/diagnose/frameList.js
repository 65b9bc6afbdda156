/**
 * The pictures as a list: thumbnail, name, outcome.
 *
 * @typedef {import("../shared/queueLogic.js").Frame} Frame
 */

import { frameNote, tally } from "../shared/queueLogic.js";

const THUMB_PX = 112;

/**
 * @param {HTMLElement} root
 * @param {{onSelect: (id: string) => void, onRemove: (id: string) => void}} events
 */
export function mountFrameList(root, { onSelect, onRemove }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  const list = find("list");
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));

  /** @param {Frame} frame */
  function row(frame) {
    const item = /** @type {HTMLElement} */ (
      /** @type {DocumentFragment} */ (template.content.cloneNode(true)).firstElementChild
    );
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (item.querySelector(`[data-ref=${name}]`));
    item.dataset.id = frame.id;
    part("title").textContent = frame.name;
    part("title").title = frame.name;
    part("open").addEventListener("click", () => onSelect(frame.id));
    part("remove").addEventListener("click", () => onRemove(frame.id));
    part("remove").setAttribute("aria-label", `Remove ${frame.name} from the list`);
    void thumbnail(frame.file, /** @type {HTMLCanvasElement} */ (part("thumb")));
    return item;
  }

  /** @param {Frame[]} frames */
  function matchRows(frames) {
    const rows = new Map([...list.children].map((el) => [/** @type {HTMLElement} */ (el).dataset.id, el]));
    const wanted = frames.map((frame) => rows.get(frame.id) ?? row(frame));
    const same = wanted.length === list.children.length && wanted.every((el, i) => el === list.children[i]);
    if (!same) list.replaceChildren(...wanted);
  }

  return {
    /** @param {{frames: Frame[], selectedId: string | null}} state */
    update({ frames, selectedId }) {
      matchRows(frames);
      root.hidden = frames.length === 0;
      const text = tally(frames);
      if (find("tally").textContent !== text) find("tally").textContent = text;
      frames.forEach((frame, at) => {
        const item = /** @type {HTMLElement} */ (list.children[at]);
        item.dataset.current = String(frame.id === selectedId);
        item.dataset.status = frame.status;
        item.querySelector("[data-ref=open]")?.setAttribute("aria-current", String(frame.id === selectedId));
        const note = /** @type {HTMLElement} */ (item.querySelector("[data-ref=note]"));
        const words = frameNote(frame);
        if (note.textContent !== words) note.textContent = note.title = words;
      });
    },
  };
}

/**
 * A small picture of a file, decoded in the background; nothing where the browser cannot.
 * @param {File | null} file
 * @param {HTMLCanvasElement} canvas
 */
async function thumbnail(file, canvas) {
  if (!file?.size) return;
  try {
    const bitmap = await createImageBitmap(file, { resizeWidth: THUMB_PX, resizeQuality: "medium" });
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
    canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
    bitmap.close();
  } catch {
    // TIFF and damaged files have no thumbnail; the server says what it makes of them.
  }
}
