/**
 * Terms with their figures.
 *
 * @typedef {[string, string, string?][]} Facts  where there is a third, a button beside the figure copies it
 */

import { copyButton } from "./copy.js";

/** @typedef {[HTMLElement, HTMLElement]} Row */

/**
 * @param {[string, string, string?]} fact
 * @returns {Row}
 */
function rowOf([term, figure, copied]) {
  const shownFigure = Object.assign(document.createElement("dd"), { textContent: figure });
  if (copied) shownFigure.append(" ", copyButton(copied, term.toLowerCase()));
  return [Object.assign(document.createElement("dt"), { textContent: term }), shownFigure];
}

/**
 * A fact that stays keeps its elements: with the focus, and what its button just said.
 * @param {HTMLElement} list  a `dl`
 * @returns {{update: (facts: Facts) => void}}
 */
export function mountFacts(list) {
  /** @type {Map<string, Row>} */
  let rows = new Map();
  return {
    update(facts) {
      const kept = rows;
      rows = new Map(
        facts.map((fact) => {
          const key = JSON.stringify(fact);
          return [key, kept.get(key) ?? rowOf(fact)];
        }),
      );
      for (const [key, row] of kept) if (!rows.has(key)) for (const element of row) element.remove();
      let next = list.firstElementChild;
      for (const element of [...rows.values()].flat()) {
        if (element === next) next = next.nextElementSibling;
        else list.insertBefore(element, next);
      }
    },
  };
}
