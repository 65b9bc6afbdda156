/**
 * The cards of one kind.
 *
 * @typedef {import("../homeLogic.js").Card} Card
 */

import { FEW } from "../homeLogic.js";
import { keyedRows } from "../../shared/components/keyedRows.js";

/**
 * @param {HTMLElement} root
 * @param {HTMLTemplateElement} template  of a card
 * @param {{onRename: (card: Card) => void, onRemove: (card: Card) => void, onAll: () => void,
 *   picture: (card: Card) => string}} events  picture: its address, empty for none
 */
export function mountShelf(root, template, { onRename, onRemove, onAll, picture }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  /** @type {Card[]} */
  let shown = [];
  const cardOf = (/** @type {string} */ key) => /** @type {Card} */ (shown.find((card) => card.key === key));
  find("more").addEventListener("click", onAll);
  const list = keyedRows(find("list"), template, {
    make: (part, key) => {
      part("rename").addEventListener("click", () => onRename(cardOf(key)));
      part("remove").addEventListener("click", () => onRemove(cardOf(key)));
      part("picture").addEventListener("error", () => part("picture").removeAttribute("src"));
    },
    fill: (part, element, card) => {
      element.dataset.state = card.state;
      /** @type {HTMLAnchorElement} */ (part("open")).href = card.href;
      part("title").textContent = part("title").title = card.name;
      part("note").textContent = part("note").title = card.note;
      part("date").textContent = card.date;
      part("rename").setAttribute("aria-label", `Rename ${card.name}`);
      part("remove").setAttribute("aria-label", `Delete ${card.name}`);
      const bar = /** @type {HTMLProgressElement} */ (part("bar"));
      bar.hidden = card.progress === null;
      bar.value = card.progress ?? 0;
      bar.setAttribute("aria-label", `${card.name}, read`);
      const image = /** @type {HTMLImageElement} */ (part("picture"));
      const url = picture(card);
      if (url && image.getAttribute("src") !== url) image.src = url;
    },
  });

  return {
    /** @param {{cards: Card[], total: number | null, isAll: boolean}} state  total: null before it is known */
    update({ cards, total, isAll }) {
      shown = isAll ? cards : cards.slice(0, FEW);
      list.update(shown);
      find("count").textContent = total ? String(total) : "";
      find("empty").hidden = total !== 0;
      find("none").hidden = !total || cards.length > 0;
      find("more").hidden = shown.length === cards.length;
      find("more").textContent = `Show all ${cards.length}`;
    },
  };
}
