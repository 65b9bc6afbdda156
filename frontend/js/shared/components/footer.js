/** What every page has: the list of its keys, which `?` opens, too, its link, and a hold on files that are dropped beside. */

import { mountCopy } from "./copy.js";

/**
 * Keep the browser from leaving the page, and what was typed on it, for a file that is dropped where nothing takes it.
 * @param {EventTarget} page
 */
export function holdStrayDrops(page) {
  for (const kind of ["dragover", "drop"]) {
    page.addEventListener(kind, (given) => {
      const event = /** @type {DragEvent} */ (given);
      const isFile = event.dataTransfer?.types.includes("Files");
      const isInput = event.target instanceof HTMLInputElement && event.target.type === "file";
      if (!isFile || !event.dataTransfer || isInput || event.defaultPrevented) return;
      event.preventDefault();
      event.dataTransfer.dropEffect = "none";
    });
  }
}

export function mountFooter() {
  holdStrayDrops(window);
  mountCopy(/** @type {HTMLElement} */ (document.getElementById("copy-address")), () => location.href);
  const dialog = /** @type {HTMLDialogElement} */ (document.getElementById("keys"));
  document.getElementById("show-keys")?.addEventListener("click", () => dialog.showModal());
  document.addEventListener("keydown", (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    const isTyping = target.matches("input:not([type=radio], [type=checkbox], [type=range]), textarea, select");
    if (event.key !== "?" || isTyping || document.querySelector("dialog[open]")) return;
    event.preventDefault();
    dialog.showModal();
  });
}
