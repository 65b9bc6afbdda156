/**
 * The other runs of the same footage, each to open or to compare with.
 *
 * @typedef {import("../../server/flightsApi.js").Flight} Flight
 */

import { differenceInWords } from "../flightLogic.js";
import { progressInWords } from "../../shared/flightStateLogic.js";
import { keyedRows } from "../../shared/components/keyedRows.js";

/**
 * @param {HTMLElement} root
 * @param {{onCompare: (id: string) => void}} events
 */
export function mountRunList(root, { onCompare }) {
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  const element = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  const list = keyedRows(element, template, {
    make: (part, key) => part("compare").addEventListener("click", () => onCompare(key)),
    fill: (part, item, { run, flight, compared }) => {
      item.dataset.current = String(compared);
      const link = /** @type {HTMLAnchorElement} */ (part("open"));
      link.href = `/flights/${run.id}`;
      part("title").textContent = run.name;
      const difference = differenceInWords(run, flight);
      part("note").textContent = part("note").title = `${progressInWords(run)}; ${difference}`;
      part("compare").textContent = compared ? "Hide" : "Compare";
      part("compare").setAttribute("aria-pressed", String(compared));
      part("compare").setAttribute("aria-label", `Compare with ${run.name}, ${difference}`);
    },
  });
  return {
    /** @param {{flight: Flight | null, runs: Flight[], compared: string | null}} state */
    update({ flight, runs, compared }) {
      root.hidden = !runs.length || !flight;
      if (!flight) return;
      list.update(runs.map((run) => ({ key: run.id, run, flight, compared: run.id === compared })));
    },
  };
}
