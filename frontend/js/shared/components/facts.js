/**
 * Terms with their figures.
 *
 * @typedef {[string, string][]} Facts
 */

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
        ...facts.flatMap(([term, figure]) => [
          Object.assign(document.createElement("dt"), { textContent: term }),
          Object.assign(document.createElement("dd"), { textContent: figure }),
        ]),
      );
    },
  };
}
