/**
 * The files of a new flight with their bars.
 *
 * @typedef {import("./uploadsLogic.js").Item} Item
 * @typedef {import("./uploadsLogic.js").Row} Row
 */

import { bytes, number, percent } from "../shared/formatLogic.js";
import { rowsOf, totals } from "./uploadsLogic.js";
import { keyedRows } from "../shared/components/keyedRows.js";

/**
 * @param {HTMLElement} root
 * @param {{onRemove: (keys: string[]) => void}} events
 */
export function mountUploadList(root, { onRemove }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  /** @type {Row[]} */
  let rows = [];
  const list = keyedRows(find("list"), /** @type {HTMLTemplateElement} */ (root.querySelector("template")), {
    make: (part, key) => {
      part("remove").addEventListener("click", () => onRemove(rows.find((row) => row.key === key)?.keys ?? []));
    },
    fill: (part, element, /** @type {Row} */ row) => {
      element.dataset.status = row.status;
      element.toggleAttribute("data-troubled", row.troubled);
      part("title").textContent = part("title").title = row.title;
      part("note").textContent = row.note;
      part("remove").setAttribute("aria-label", `Remove ${row.title}`);
      const bar = /** @type {HTMLProgressElement} */ (part("bar"));
      bar.value = row.share;
      bar.setAttribute("aria-label", `${row.title}, sent`);
    },
  });

  return {
    /** @param {{items: Item[]}} state */
    update({ items }) {
      root.hidden = !items.length;
      rows = rowsOf(items);
      list.update(rows);
      const { sent, size, done, total } = totals(items);
      const word = total === 1 ? "file" : "files";
      const text = done === total ? `${number(total)} ${word} sent` : `Sending ${number(total)} ${word}`;
      // Screen readers hear the word change, not every figure.
      if (find("total").textContent !== text) find("total").textContent = text;
      find("rate").textContent = done === total ? bytes(size) : `${percent(sent, size)} of ${bytes(size)}`;
    },
  };
}
