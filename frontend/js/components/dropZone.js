/** Takes files that are dropped anywhere on the page, chosen with the button, or pasted. */

/**
 * @param {HTMLElement} zone  lights up while files hover over the page; holds a file input
 * @param {{onFiles: (files: File[]) => void}} events
 */
export function mountDropZone(zone, { onFiles }) {
  const input = /** @type {HTMLInputElement} */ (zone.querySelector("input[type=file]"));
  const take = (/** @type {FileList | null | undefined} */ list) => {
    if (list?.length) onFiles([...list]);
  };
  input.addEventListener("change", () => {
    take(input.files);
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
    take(event.dataTransfer?.files);
  });
  document.addEventListener("paste", (event) => take(event.clipboardData?.files));
}
