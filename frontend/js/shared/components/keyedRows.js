/**
 * Rows that are kept by their key, so that focus and hover outlive an update.
 *
 * @typedef {(name: string) => HTMLElement} Part  finds an element of a row by its `data-ref`
 */

/**
 * @template {{key: string}} T
 * @param {HTMLElement} list
 * @param {HTMLTemplateElement} template  of one row
 * @param {{make?: (part: Part, key: string) => void,
 *   fill: (part: Part, element: HTMLElement, row: T) => void}} how
 */
export function keyedRows(list, template, { make, fill }) {
  /** @type {Map<string, {element: HTMLElement, part: Part, shown: string}>} */
  const kept = new Map();

  /** @param {string} key */
  function newRow(key) {
    const element = /** @type {HTMLElement} */ (
      /** @type {DocumentFragment} */ (template.content.cloneNode(true)).firstElementChild
    );
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (element.querySelector(`[data-ref=${name}]`));
    make?.(part, key);
    return { element, part, shown: "" };
  }

  return {
    /** @param {T[]} rows */
    update(rows) {
      const wanted = rows.map((row) => {
        const found = kept.get(row.key) ?? newRow(row.key);
        kept.set(row.key, found);
        const text = JSON.stringify(row);
        if (text !== found.shown) fill(found.part, found.element, row);
        found.shown = text;
        return found.element;
      });
      const keys = new Set(rows.map((row) => row.key));
      for (const key of [...kept.keys()]) if (!keys.has(key)) kept.delete(key);
      const same = wanted.length === list.children.length && wanted.every((el, at) => el === list.children[at]);
      if (!same) list.replaceChildren(...wanted);
    },
  };
}
