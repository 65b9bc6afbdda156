/** The pad as a file: one button a kind. */

/**
 * @param {HTMLElement} root
 * @param {{onDownload: (kind: string) => void}} events
 */
export function mountDownloads(root, { onDownload }) {
  const buttons = [...root.querySelectorAll("button")];
  for (const button of buttons) {
    button.addEventListener("click", () => {
      onDownload(button.dataset.kind ?? "");
    });
  }
  return {
    /** @param {{enabled: boolean}} state */
    update({ enabled }) {
      for (const button of buttons) button.disabled = !enabled;
    },
  };
}
