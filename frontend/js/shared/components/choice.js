/**
 * A select of stored things in groups, beside a button that uploads another.
 *
 * @typedef {{id: string, text: string}} Option
 * @typedef {{label: string, options: Option[]}} Group
 */

/**
 * @param {HTMLElement} root  holds a select and a file input
 * @param {{onChoose: (id: string) => void, onFile: (file: File) => void}} events
 */
export function mountChoice(root, { onChoose, onFile }) {
  const select = /** @type {HTMLSelectElement} */ (root.querySelector("select"));
  const input = /** @type {HTMLInputElement} */ (root.querySelector("input[type=file]"));
  const note = /** @type {HTMLElement} */ (root.querySelector("[data-ref=note]"));
  const placeholder = select.options[0];
  let shown = "";
  select.addEventListener("change", () => onChoose(select.value));
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) onFile(file);
  });

  /** @param {Group} group */
  function optgroup(group) {
    const element = document.createElement("optgroup");
    element.label = group.label;
    element.append(...group.options.map(({ id, text }) => new Option(text, id)));
    return element;
  }

  return {
    /** @param {{groups: Group[], chosen: string, note: string}} state */
    update({ groups, chosen, note: text }) {
      const filled = groups.filter((group) => group.options.length);
      const key = JSON.stringify(filled);
      if (key !== shown) {
        shown = key;
        select.replaceChildren(placeholder, ...filled.map(optgroup));
      }
      if (select.value !== chosen) select.value = chosen;
      if (note.textContent !== text) note.textContent = text;
    },
  };
}
