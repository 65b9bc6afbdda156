/** What every page's foot offers: the list of its keys, which `?` opens, too, and its link. */

import { mountCopy } from "./copy.js";

export function mountFooter() {
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
