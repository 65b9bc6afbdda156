/** The order of the paper's experiments, as the form has it. */

/**
 * @param {HTMLFormElement} form
 * @returns {Record<string, unknown>}
 */
export function reproductionOrder(form) {
  const seeds = /** @type {HTMLInputElement} */ (form.elements.namedItem("seeds"));
  const ticked = /** @type {NodeListOf<HTMLInputElement>} */ (form.querySelectorAll("[name=only]:checked"));
  return { seeds: Number(seeds.value), only: [...ticked].map(({ value }) => value) };
}
