/** Asks for another name. */

import { messageOf } from "../../server/request.js";

/**
 * @param {HTMLDialogElement} dialog
 * @param {{onRename: (card: import("../homeLogic.js").Card, name: string) => Promise<void>}} events
 *   a refusal is shown in the dialog
 */
export function mountRenameDialog(dialog, { onRename }) {
  const form = /** @type {HTMLFormElement} */ (dialog.querySelector("form"));
  const input = /** @type {HTMLInputElement} */ (dialog.querySelector("input"));
  const fault = /** @type {HTMLElement} */ (dialog.querySelector(".field-error"));
  /** @type {import("../homeLogic.js").Card | null} */
  let card = null;

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const name = input.value.trim();
    if (!card) return;
    if (!name) {
      fault.textContent = "Enter a name.";
      return;
    }
    try {
      await onRename(card, name);
      dialog.close();
    } catch (error) {
      fault.textContent = messageOf(error);
    }
  });
  /** @type {HTMLElement} */ (dialog.querySelector("[data-ref=close]")).addEventListener("click", () => dialog.close());

  return {
    /** @param {import("../homeLogic.js").Card} wanted */
    open(wanted) {
      card = wanted;
      fault.textContent = "";
      input.value = wanted.name;
      dialog.showModal();
      input.select();
    },
  };
}
