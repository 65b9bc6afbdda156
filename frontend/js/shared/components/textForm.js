/**
 * A form of texts. The controller checks them; faults stand beside their fields.
 *
 * @typedef {Record<string, string>} Texts
 */

/**
 * @param {HTMLFormElement} form  each named field may have a place for its fault, `<its id>-error`
 * @param {{onInput: (texts: Texts) => void, onSubmit?: () => void}} events
 */
export function mountTextForm(form, { onInput, onSubmit }) {
  const fields = /** @type {(HTMLInputElement | HTMLSelectElement)[]} */ (
    [...form.querySelectorAll("[name]")]
  );
  form.addEventListener("input", () => {
    onInput(Object.fromEntries(fields.map((field) => [field.name, valueOf(field)])));
  });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const first = fields.find((field) => field.getAttribute("aria-invalid") === "true");
    if (first) first.focus();
    else onSubmit?.();
  });

  /** @param {HTMLInputElement | HTMLSelectElement} field @param {string} fault */
  function showFault(field, fault) {
    const place = document.getElementById(`${field.id}-error`);
    if (!place) return;
    if (place.textContent !== fault) place.textContent = fault;
    field.setAttribute("aria-invalid", String(Boolean(fault)));
  }

  return {
    /** @param {{texts: Texts, errors: Texts}} state */
    update({ texts, errors }) {
      for (const field of fields) {
        setValue(field, texts[field.name] ?? "");
        showFault(field, errors[field.name] ?? "");
      }
    },
  };
}

/** @param {HTMLInputElement | HTMLSelectElement} field */
const valueOf = (field) => (isCheckbox(field) ? String(field.checked) : field.value);

/** @param {HTMLInputElement | HTMLSelectElement} field @param {string} text */
function setValue(field, text) {
  if (isCheckbox(field)) field.checked = text === "true";
  else if (field.value !== text) field.value = text;
}

/**
 * @param {HTMLInputElement | HTMLSelectElement} field
 * @returns {field is HTMLInputElement}
 */
const isCheckbox = (field) => field instanceof HTMLInputElement && field.type === "checkbox";
