/** Links that download a flight's poses, one a form. */

import { EXPORTS } from "../flightLogic.js";
import { exportUrl } from "../../server/flightsApi.js";

/**
 * @param {HTMLElement} root
 * @param {string} id  of the flight
 * @param {{onVehicle: (file: File) => void, onExport: (url: string) => void}} events
 */
export function mountExportList(root, id, { onVehicle, onExport }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  list.replaceChildren(
    ...EXPORTS.map(({ form, name, about }) => {
      const link = document.createElement("a");
      link.className = "export-link";
      link.dataset.form = form;
      link.download = "";
      link.addEventListener("click", (event) => {
        event.preventDefault();
        onExport(link.href);
      });
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
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  let offered = "";

  function lead() {
    for (const link of /** @type {NodeListOf<HTMLAnchorElement>} */ (list.querySelectorAll("a"))) {
      link.href = exportUrl(id, link.dataset.form ?? "", find("pad").value);
    }
  }
  find("pad").addEventListener("change", lead);
  lead();

  return {
    /** @param {{enabled: boolean, pads: import("../../server/answers.js").KnownPad[]}} state */
    update({ enabled, pads }) {
      root.hidden = !enabled;
      find("pad-field").hidden = pads.length < 2;
      const key = JSON.stringify(pads);
      if (key === offered) return;
      offered = key;
      const each = pads.map(({ name, pad_id: printed }) => new Option(name || printed, printed));
      find("pad").replaceChildren(new Option("all pads", ""), ...each);
      lead();
    },
  };
}
