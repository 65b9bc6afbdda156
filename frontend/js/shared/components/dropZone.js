/** Takes files that are dropped anywhere on the page, chosen with a button, or pasted. */

import { chosenFrom, filesOf } from "./droppedFiles.js";

/**
 * @param {HTMLElement} zone  lights up while files hover over the page; holds file inputs
 * @param {{onFiles: (files: File[], chosen: import("./droppedFiles.js").Chosen[]) => void}} events
 *   the files, and the same with the folders in which they lay
 */
export function mountDropZone(zone, { onFiles }) {
  const take = (/** @type {import("./droppedFiles.js").Chosen[]} */ chosen) => {
    if (chosen.length) onFiles(chosen.map(({ file }) => file), chosen);
  };
  zone.addEventListener("change", (event) => {
    const input = /** @type {HTMLInputElement} */ (event.target);
    take(chosenFrom(input.files ?? []));
    input.value = "";
  });
  const holdsFiles = (/** @type {DragEvent} */ event) =>
    event.dataTransfer?.types.includes("Files") ?? false;
  document.addEventListener("dragover", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    zone.dataset.over = "true";
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) delete zone.dataset.over;
  });
  document.addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    delete zone.dataset.over;
    if (event.dataTransfer) void filesOf(event.dataTransfer).then(take);
  });
  document.addEventListener("paste", (event) => take(chosenFrom(event.clipboardData?.files ?? [])));
}
