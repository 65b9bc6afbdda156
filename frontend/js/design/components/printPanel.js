/**
 * How the pad is printed: the form, what the sheets come to, the measured size, the test strip.
 * It holds texts; the controller checks them and asks the server.
 *
 * @typedef {Record<string, string>} Texts
 * @typedef {import("../../shared/components/facts.js").Facts} Facts
 *
 * @typedef {object} PrintPanelState
 * @property {Texts} texts
 * @property {Texts} errors
 * @property {string} fault  why no sheets can be planned
 * @property {Facts} facts
 * @property {[string, string]} rulers  what the printed rulers read
 * @property {boolean} isSaved
 * @property {string} live  address at which the print is held before a camera
 * @property {{facts: Facts, warnings: string[], note: string, kept: boolean} | null} strip  what a
 *   photo of the test strip says
 */

import { mountFacts } from "../../shared/components/facts.js";
import { makeDraft } from "../../shared/address.js";
import { mountTextForm } from "../../shared/components/textForm.js";

/**
 * @param {HTMLElement} root
 * @param {{onInput: (texts: Texts) => void, onMeasured: (x: string, y: string) => void,
 *   onStripPhoto: (photo: File) => void, onStripForget: () => void}} events
 */
export function mountPrintPanel(root, { onInput, onMeasured, onStripPhoto, onStripForget }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  const form = mountTextForm(/** @type {HTMLFormElement} */ (find("options")), { onInput });
  const measured = /** @type {HTMLFormElement} */ (find("measured"));
  const rulers = /** @type {HTMLInputElement[]} */ ([...measured.querySelectorAll("input")]);
  const facts = mountFacts(find("facts"));
  const stripFacts = mountFacts(find("strip-facts"));
  let shownRulers = "";
  const draft = makeDraft("rulers", () => rulers, () => shownRulers);

  measured.addEventListener("submit", (event) => {
    event.preventDefault();
    draft.forget();
    onMeasured(rulers[0].value, rulers[1].value);
  });
  const photo = /** @type {HTMLInputElement} */ (find("strip-photo"));
  photo.addEventListener("change", () => {
    const file = photo.files?.[0];
    photo.value = "";
    if (file) onStripPhoto(file);
  });
  find("strip-forget").addEventListener("click", onStripForget);

  return {
    /** @param {PrintPanelState} state */
    update({ texts, errors, fault, facts: shown, rulers: read, isSaved, live, strip }) {
      form.update({ texts, errors });
      find("custom").hidden = texts.paper !== "custom";
      find("overlap").hidden = texts.joint !== "overlap";
      find("sheet-options").toggleAttribute("inert", texts.paper === "own");
      find("fault").textContent = fault;
      facts.update(shown);
      // Readings being typed stay until the pad's own change.
      if (read.join() !== shownRulers) {
        shownRulers = read.join();
        const texts = draft.read() ?? read;
        rulers.forEach((input, place) => { input.value = texts[place]; });
      }
      find("live").setAttribute("href", live);
      find("measured-note").textContent = isSaved ? "" : "Entering a size saves the pad first.";
      stripFacts.update(strip?.facts ?? []);
      find("strip-warning").textContent = strip?.warnings.join(" ") ?? "";
      find("strip-note").textContent = strip?.note ?? "";
      find("strip-forget").hidden = !strip?.kept;
    },
  };
}
