/**
 * How the pad is printed: the form, what the sheets come to, the measured size, the test strip.
 * It holds texts; the controller checks them and asks the server.
 *
 * @typedef {Record<string, string>} Texts
 * @typedef {import("./facts.js").Facts} Facts
 *
 * @typedef {object} PrintPanelState
 * @property {Texts} texts
 * @property {Texts} errors
 * @property {string} fault  why no sheets can be planned
 * @property {Facts} facts
 * @property {string} warning  a dead band between the layers
 * @property {[string, string]} rulers  what the printed rulers read
 * @property {boolean} isSaved
 * @property {{facts: Facts, warnings: string[]} | null} strip  what a photo of the test strip says
 */

import { mountFacts } from "./facts.js";

/**
 * @param {HTMLElement} root
 * @param {{onInput: (texts: Texts) => void, onMeasured: (x: string, y: string) => void,
 *   onStripPhoto: (photo: File) => void}} events
 */
export function mountPrintPanel(root, { onInput, onMeasured, onStripPhoto }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  const form = /** @type {HTMLFormElement} */ (find("options"));
  const fields = /** @type {(HTMLInputElement | HTMLSelectElement)[]} */ (
    [...form.querySelectorAll("[name]")]
  );
  const measured = /** @type {HTMLFormElement} */ (find("measured"));
  const rulers = /** @type {HTMLInputElement[]} */ ([...measured.querySelectorAll("input")]);
  const facts = mountFacts(find("facts"));
  const stripFacts = mountFacts(find("strip-facts"));
  let shownRulers = "";

  form.addEventListener("input", () => {
    onInput(Object.fromEntries(fields.map((field) => [field.name, valueOf(field)])));
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  measured.addEventListener("submit", (event) => {
    event.preventDefault();
    onMeasured(rulers[0].value, rulers[1].value);
  });
  const photo = /** @type {HTMLInputElement} */ (find("strip-photo"));
  photo.addEventListener("change", () => {
    const file = photo.files?.[0];
    photo.value = "";
    if (file) onStripPhoto(file);
  });

  /** @param {HTMLInputElement | HTMLSelectElement} field @param {string} fault */
  function showFault(field, fault) {
    const place = document.getElementById(`print-${field.name}-error`);
    if (!place) return;
    if (place.textContent !== fault) place.textContent = fault;
    field.setAttribute("aria-invalid", String(Boolean(fault)));
  }

  return {
    /** @param {PrintPanelState} state */
    update({ texts, errors, fault, facts: shown, warning, rulers: read, isSaved, strip }) {
      for (const field of fields) {
        setValue(field, texts[field.name] ?? "");
        showFault(field, errors[field.name] ?? "");
      }
      find("custom").hidden = texts.paper !== "custom";
      find("overlap").hidden = texts.joint !== "overlap";
      find("sheet-options").toggleAttribute("inert", texts.paper === "own");
      find("fault").textContent = fault;
      facts.update(shown);
      find("warning").textContent = warning;
      // Readings being typed stay until the pad's own change.
      if (read.join() !== shownRulers) {
        shownRulers = read.join();
        rulers.forEach((input, place) => { input.value = read[place]; });
      }
      find("measured-note").textContent = isSaved ? "" : "Entering a size saves the pad first.";
      stripFacts.update(strip?.facts ?? []);
      find("strip-warning").textContent = strip?.warnings.join(" ") ?? "";
    },
  };
}

/** @param {HTMLInputElement | HTMLSelectElement} field */
const valueOf = (field) =>
  field instanceof HTMLInputElement && field.type === "checkbox" ? String(field.checked) : field.value;

/** @param {HTMLInputElement | HTMLSelectElement} field @param {string} text */
function setValue(field, text) {
  if (field instanceof HTMLInputElement && field.type === "checkbox") field.checked = text === "true";
  else if (field.value !== text) field.value = text;
}
