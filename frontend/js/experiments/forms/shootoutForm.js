/** The order of a shoot-out, as the form has it. */

/**
 * @param {HTMLFormElement} form
 * @returns {Record<string, unknown>}
 */
export function shootoutOrder(form) {
  const value = (/** @type {string} */ name) =>
    /** @type {HTMLInputElement | HTMLSelectElement} */ (form.elements.namedItem(name)).value;
  const chosen = (/** @type {string} */ id) => /** @type {HTMLSelectElement} */ (form.querySelector(`#${id} select`)).value;
  const ticked = /** @type {NodeListOf<HTMLInputElement>} */ (form.querySelectorAll("[name=boards]:checked"));
  return {
    pad: chosen("shootout-pad"),
    camera: chosen("shootout-camera"),
    flight: value("flight"),
    frames: Number(value("frames")),
    from_mm: Number(value("from_mm")),
    to_mm: Number(value("to_mm")),
    look: value("look"),
    ground: value("ground"),
    disturbances: value("disturbances").split(/\s+/).filter(Boolean),
    boards: [...ticked].map(({ value: board }) => board),
  };
}
