/** Links that download a flight's poses, one a form. */

import { EXPORTS } from "../flightLogic.js";
import { exportUrl } from "../../server/flightsApi.js";

/**
 * @param {HTMLElement} root
 * @param {string} id  of the flight
 * @param {{onVehicle: (file: File) => void}} events
 */
export function mountExportList(root, id, { onVehicle }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  list.replaceChildren(
    ...EXPORTS.map(({ form, name, about }) => {
      const link = document.createElement("a");
      link.className = "export-link";
      link.href = exportUrl(id, form);
      link.download = "";
      const note = Object.assign(document.createElement("span"), { className: "quiet", textContent: about });
      link.append(Object.assign(document.createElement("span"), { textContent: name }), " ", note);
      const item = document.createElement("li");
      item.append(link);
      return item;
    }),
  );
  const input = /** @type {HTMLInputElement} */ (root.querySelector("input[type=file]"));
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) onVehicle(file);
  });
  return {
    /** @param {{enabled: boolean}} state */
    update({ enabled }) {
      root.hidden = !enabled;
    },
  };
}
