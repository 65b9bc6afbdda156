/** How long the chosen camera's shutter rolls: shown, and stored where it is known better. */

import { readoutFrom, readoutText } from "../readingLogic.js";

/**
 * @param {HTMLElement} root  a form with a field
 * @param {{onReadout: (readoutMs: number | null) => void}} events
 */
export function mountShutterField(root, { onReadout }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const input = /** @type {HTMLInputElement} */ (find("readout"));
  /** @type {string | null} */
  let shown = null;

  function store() {
    const { readout, fault } = readoutFrom(input.value);
    find("error").textContent = fault;
    input.ariaInvalid = String(Boolean(fault));
    if (!fault && readoutText(readout) !== shown) onReadout(readout);
  }

  find("store").addEventListener("click", store);
  // The field may lie within another form, which Enter is not to send.
  input.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    store();
  });
  return {
    /** @param {{camera: import("../../server/api.js").CameraSummary | undefined}} state */
    update({ camera }) {
      root.hidden = !camera;
      const key = camera ? `${camera.id} ${readoutText(camera.readout_ms ?? null)}` : "";
      if (root.dataset.camera === key) return;
      root.dataset.camera = key;
      shown = readoutText(camera?.readout_ms ?? null);
      input.value = shown;
      find("error").textContent = "";
      input.ariaInvalid = "false";
    },
  };
}
