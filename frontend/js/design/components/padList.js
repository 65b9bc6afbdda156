/**
 * The saved pads: open, delete (asked twice).
 *
 * @typedef {import("../../server/api.js").PadSummary} PadSummary
 */

import { moment, size } from "../../shared/formatLogic.js";

/**
 * @param {HTMLElement} root
 * @param {{onOpen: (id: string) => void, onDelete: (id: string) => void}} events
 */
export function mountPadList(root, { onOpen, onDelete }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  const empty = /** @type {HTMLElement} */ (root.querySelector("[data-ref=empty]"));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  let shown = "";

  /** @param {PadSummary} pad */
  function row(pad) {
    const item = /** @type {HTMLElement} */ (
      /** @type {DocumentFragment} */ (template.content.cloneNode(true)).firstElementChild
    );
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (item.querySelector(`[data-ref=${name}]`));
    item.dataset.id = pad.id;
    part("title").textContent = pad.name;
    part("note").textContent = `${size(...pad.size_mm)} · ${moment(pad.created_at)}`;
    part("open").addEventListener("click", () => onOpen(pad.id));
    const remove = part("delete");
    remove.setAttribute("aria-label", `Delete ${pad.name}`);
    remove.addEventListener("click", () => {
      if (remove.dataset.asked) return onDelete(pad.id);
      remove.dataset.asked = "true";
      remove.textContent = "Delete?";
      remove.setAttribute("aria-label", `Really delete ${pad.name}?`);
    });
    remove.addEventListener("blur", () => {
      delete remove.dataset.asked;
      remove.textContent = "×";
      remove.setAttribute("aria-label", `Delete ${pad.name}`);
    });
    return item;
  }

  return {
    /** @param {{pads: PadSummary[], currentId: string | null}} state */
    update({ pads, currentId }) {
      const key = JSON.stringify(pads.map((pad) => pad.id));
      if (key !== shown) {
        shown = key;
        list.replaceChildren(...pads.map(row));
      }
      empty.hidden = pads.length > 0;
      for (const item of /** @type {Iterable<HTMLElement>} */ (list.children)) {
        const current = item.dataset.id === currentId;
        item.dataset.current = String(current);
        item.querySelector("[data-ref=open]")?.setAttribute("aria-current", String(current));
      }
    },
  };
}
