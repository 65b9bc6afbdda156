/** What is right and wrong with the print, each with its figure and what to do. */

import { sentence } from "../liveLogic.js";

const MARKS = { good: "good", fair: "fair", bad: "poor", unknown: "not known" };

/** @param {HTMLElement} root */
export function mountPrintPanel(root) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  let shown = "";

  /** @param {import("../../server/liveApi.js").PrintItem} item */
  function row({ name, verdict, text, advice }) {
    const element = /** @type {HTMLElement} */ (template.content.firstElementChild?.cloneNode(true));
    const write = (/** @type {string} */ ref, /** @type {string} */ words) => {
      /** @type {HTMLElement} */ (element.querySelector(`[data-ref=${ref}]`)).textContent = words;
    };
    element.dataset.verdict = verdict;
    write("name", name);
    write("mark", MARKS[verdict]);
    write("text", sentence(text));
    write("advice", sentence(advice));
    return element;
  }

  return {
    /** @param {{session: import("../../server/liveApi.js").Session | null}} state */
    update({ session }) {
      const items = session?.print_check ?? [];
      root.hidden = items.length === 0;
      const key = JSON.stringify(items);
      if (key === shown) return;
      shown = key;
      list.replaceChildren(...items.map(row));
    },
  };
}
