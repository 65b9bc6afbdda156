/** How camera files are read and saved: what the user says of a lens, which of several cameras, which form. */

import { CAMERA_FORMS, importCamera } from "../../server/api.js";
import { ApiError } from "../../server/request.js";

/** Refusals that what stands here takes away. */
const ANSWERED_HERE = ["distortion_not_said", "several_cameras"];

/**
 * @param {HTMLElement} root  details
 * @param {{onForm: (form: string) => void}} events
 */
export function mountCameraFiles(root, { onForm }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  find("form").append(...Object.keys(CAMERA_FORMS).map((form) => new Option(form, form)));
  find("form").addEventListener("change", () => onForm(find("form").value));

  return {
    /** Import a file as is said here; a file of its own kind is asked anew. @param {File} file */
    async send(file) {
      const said = { noDistortion: find("no-distortion").checked, which: find("which").value.trim() };
      try {
        const camera = await importCamera(file, said);
        find("no-distortion").checked = false;
        find("which").value = "";
        return camera;
      } catch (error) {
        if (error instanceof ApiError && ANSWERED_HERE.includes(error.code)) {
          /** @type {HTMLDetailsElement} */ (root).open = true;
        }
        throw error;
      }
    },
    /** @param {{form: string}} state */
    update({ form }) {
      find("form").value = form;
    },
  };
}
