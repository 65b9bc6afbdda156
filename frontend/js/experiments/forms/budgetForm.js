/** The order of an error budget, as the form has it. */

/**
 * @param {HTMLFormElement} form
 * @returns {Record<string, unknown>}
 */
export function budgetOrder(form) {
  const field = (/** @type {string} */ name) => /** @type {HTMLInputElement | HTMLSelectElement} */ (form.elements.namedItem(name));
  const chosen = (/** @type {string} */ id) => /** @type {HTMLSelectElement} */ (form.querySelector(`#${id} select`)).value;
  const sizes = /** @type {NodeListOf<HTMLInputElement>} */ (form.querySelectorAll("[data-quantity]"));
  const given = [...sizes].filter(({ value }) => value !== "");
  return {
    pad: chosen("budget-pad"),
    camera: chosen("budget-camera"),
    height_mm: Number(field("height_mm").value),
    frames: Number(field("frames").value),
    codec: field("codec").value,
    is_checked: /** @type {HTMLInputElement} */ (field("is_checked")).checked,
    conditions: Object.fromEntries(given.map(({ name, value }) => [name, Number(value)])),
  };
}
