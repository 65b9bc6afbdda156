/**
 * Terms with their figures.
 *
 * @typedef {[string, string, string?][]} Facts  where there is a third, a button beside the figure copies it
 */

import { copyButton } from "./copy.js";

/**
 * @param {HTMLElement} list  a `dl`
 * @returns {{update: (facts: Facts) => void}}
 */
export function mountFacts(list) {
  let shown = "";
  return {
    update(facts) {
      const key = JSON.stringify(facts);
      if (key === shown) return;
      shown = key;
      list.replaceChildren(
        ...facts.flatMap(([term, figure, copied]) => {
          const shownFigure = Object.assign(document.createElement("dd"), { textContent: figure });
          if (copied) shownFigure.append(" ", copyButton(copied, term.toLowerCase()));
          return [Object.assign(document.createElement("dt"), { textContent: term }), shownFigure];
        }),
      );
    },
  };
}
