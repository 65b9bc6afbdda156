/**
 * A select of stored things in groups, after the choice of none.
 *
 * @typedef {import("../../shared/components/choice.js").Group} Group
 */

/**
 * @param {HTMLSelectElement} select  its first option stays
 * @param {{onChoose: (id: string) => void}} events
 */
export function mountOptions(select, { onChoose }) {
  const none = select.options[0];
  let shown = "";
  select.addEventListener("change", () => onChoose(select.value));

  /** @param {Group} group */
  function optgroup({ label, options }) {
    const element = document.createElement("optgroup");
    element.label = label;
    element.append(...options.map(({ id, text }) => new Option(text, id)));
    return element;
  }

  return {
    /** @param {{groups: Group[], chosen: string}} state */
    update({ groups, chosen }) {
      const filled = groups.filter((group) => group.options.length);
      const key = JSON.stringify(filled);
      if (key !== shown) {
        shown = key;
        select.replaceChildren(none, ...filled.map(optgroup));
      }
      if (select.value !== chosen) select.value = chosen;
    },
  };
}
