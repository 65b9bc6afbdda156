/**
 * A map of simulated frames: the share that was read, a row a height, a column a tilt or blur.
 *
 * @typedef {import("../server/planApi.js").SuccessMap} SuccessMap
 */

import { length } from "../shared/formatLogic.js";
import { valueInWords } from "./planLogic.js";

/** @param {HTMLTableElement} table  with a head and a body, both empty */
export function mountSuccessMap(table) {
  const head = /** @type {HTMLTableSectionElement} */ (table.tHead);
  const body = table.tBodies[0];
  /** @type {SuccessMap | null} */
  let shown = null;

  /** @param {string} text */
  const headCell = (text) => {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    return cell;
  };

  return {
    /** @param {{map: SuccessMap | null}} state */
    update({ map }) {
      table.hidden = !map;
      if (map === shown) return;
      shown = map;
      head.replaceChildren();
      body.replaceChildren();
      if (!map) return;
      const titles = ["Height", ...map.values.map((value) => valueInWords(map.axis, value))];
      head.insertRow().append(...titles.map(headCell));
      map.heights_mm.forEach((height, row) => {
        const line = body.insertRow();
        const title = document.createElement("th");
        title.scope = "row";
        title.textContent = length(height);
        line.append(title, ...map.success[row].map((share, col) => mapCell(share, map.wrong[row][col])));
      });
    },
  };
}

/** @param {number} share @param {number} wrong */
function mapCell(share, wrong) {
  const cell = document.createElement("td");
  cell.className = "figure";
  cell.dataset.share = wrong ? "wrong" : share >= 1 ? "all" : share > 0 ? "some" : "none";
  cell.textContent = `${Math.round(100 * share)} %`;
  if (wrong) cell.title = `${Math.round(100 * wrong)} % with a false pose`;
  return cell;
}
