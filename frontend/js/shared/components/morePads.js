/** More stored pads, each with a tick, that pictures may show besides the chosen one. */

/**
 * @param {HTMLElement} root  holds a list and a template of one row
 * @param {{onChoose: (ids: string[]) => void}} events
 */
export function mountMorePads(root, { onChoose }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  const list = find("list");
  let shown = "";
  const inputs = () => /** @type {HTMLInputElement[]} */ ([...list.querySelectorAll("input")]);
  list.addEventListener("change", () => {
    onChoose(inputs().filter((input) => input.checked).map((input) => input.value));
  });

  /** @param {import("./choice.js").Option} option */
  function row({ id, text }) {
    const item = /** @type {HTMLElement} */ (
      /** @type {DocumentFragment} */ (template.content.cloneNode(true)).firstElementChild
    );
    /** @type {HTMLInputElement} */ (item.querySelector("input")).value = id;
    /** @type {HTMLElement} */ (item.querySelector("span")).textContent = text;
    return item;
  }

  return {
    /** @param {{options: import("./choice.js").Option[], chosen: string[], note: string}} state */
    update({ options, chosen, note }) {
      const key = JSON.stringify(options);
      if (key !== shown) {
        shown = key;
        list.replaceChildren(...options.map(row));
      }
      for (const input of inputs()) input.checked = chosen.includes(input.value);
      root.hidden = !options.length;
      if (find("note").textContent !== note) find("note").textContent = note;
    },
  };
}
