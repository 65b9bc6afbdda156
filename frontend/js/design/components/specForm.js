/**
 * The form of a pad's specification. It holds texts; the controller checks them.
 *
 * @typedef {import("../specLogic.js").SpecErrors} SpecErrors
 * @typedef {import("../specLogic.js").Bounds} Bounds
 */

/**
 * @param {HTMLFormElement} form
 * @param {{onInput: (texts: Record<string, string>) => void, onSave: () => void}} events
 */
export function mountSpecForm(form, { onInput, onSave }) {
  const fields = /** @type {(HTMLInputElement | HTMLSelectElement)[]} */ (
    [...form.querySelectorAll("[name]")]
  );
  const advanced = /** @type {HTMLDetailsElement} */ (form.querySelector("details"));
  form.addEventListener("input", () => {
    onInput(Object.fromEntries(fields.map((field) => [field.name, field.value])));
  });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const first = fields.find((field) => field.getAttribute("aria-invalid") === "true");
    if (first) first.focus();
    else onSave();
  });

  /** @param {HTMLInputElement | HTMLSelectElement} field @param {string} fault */
  function showFault(field, fault) {
    const place = /** @type {HTMLElement} */ (document.getElementById(`${field.name}-error`));
    if (place.textContent !== fault) place.textContent = fault;
    field.setAttribute("aria-invalid", String(Boolean(fault)));
    if (fault && advanced.contains(field)) advanced.open = true;
  }

  return {
    bounds: boundsOf(fields),
    /**
     * @param {{texts: Record<string, string>, errors: SpecErrors, saving: boolean,
     *   words: Record<"sheet" | "possible" | "capacity" | "largest" | "outlook", string>}} state
     */
    update({ texts, errors, words, saving }) {
      for (const field of fields) {
        const text = texts[field.name] ?? "";
        if (field.value !== text) field.value = text;
        showFault(field, errors[/** @type {keyof SpecErrors} */ (field.name)] ?? "");
      }
      for (const [name, text] of Object.entries(words)) {
        const place = /** @type {HTMLElement} */ (form.querySelector(`[data-ref=${name}]`));
        if (place.textContent !== text) place.textContent = text;
      }
      const save = /** @type {HTMLButtonElement} */ (form.querySelector("[type=submit]"));
      save.disabled = saving;
      save.textContent = saving ? "Saving …" : "Save pad";
    },
  };
}

/**
 * The bounds that the numeric fields' attributes give.
 * @param {(HTMLInputElement | HTMLSelectElement)[]} fields
 * @returns {Bounds}
 */
function boundsOf(fields) {
  /** @type {Bounds} */
  const bounds = {};
  for (const field of fields) {
    if (!(field instanceof HTMLInputElement) || field.type !== "number") continue;
    bounds[field.name] = {
      least: Number(field.min),
      most: Number(field.max),
      whole: field.step !== "any",
      label: field.labels?.[0]?.textContent ?? field.name,
    };
  }
  return bounds;
}
