/**
 * Expected against read: where the pose comes from, what the cells say, which are wrong.
 *
 * @typedef {import("../../server/tuningApi.js").CellsAnswer} CellsAnswer
 */

import { number } from "../formatLogic.js";
import { MOST_ROWS, margin, verdictOf, wrongCells } from "./cellsLogic.js";

/**
 * @param {HTMLElement} root
 * @param {object} events
 * @param {(from: "own" | "corners" | "neighbour" | null) => void} events.onFrom
 * @param {(channel: string) => void} events.onLayer
 * @param {(at: {x: number, y: number}) => void} events.onCell
 */
export function mountCellsPanel(root, { onFrom, onLayer, onCell }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  for (const from of /** @type {const} */ (["own", "corners", "neighbour"])) {
    find(`cells-${from}`).addEventListener("click", () => onFrom(from));
  }
  find("cells-off").addEventListener("click", () => onFrom(null));
  find("cells-layers").addEventListener("change", (/** @type {any} */ event) => onLayer(event.target.value));
  /** @type {unknown} */
  let shown = null;

  /** @param {CellsAnswer["layers"][number]} layer */
  function rowsOf(layer) {
    return wrongCells(layer).slice(0, MOST_ROWS).map((k) => {
      const row = document.createElement("tr");
      const go = Object.assign(document.createElement("button"), {
        type: "button", className: "button button-plain cells-go", textContent: `${layer.row[k]}, ${layer.column[k]}`,
      });
      go.setAttribute("aria-label", `Show the cell in row ${layer.row[k]}, column ${layer.column[k]}`);
      go.addEventListener("click", () => onCell({ x: layer.x[k] + 0.5, y: layer.y[k] + 0.5 }));
      const texts = [
        String(layer.expected[k]), String(layer.level[k]), number(layer.grey[k], 1),
        layer.thresholds[k].map((value) => number(value, 1)).join(", "), number(margin(layer, k), 1),
      ];
      const cells = texts.map((textContent) => Object.assign(document.createElement("td"), { textContent }));
      const head = document.createElement("th");
      head.scope = "row";
      head.append(go);
      row.append(head, ...cells);
      return row;
    });
  }

  return {
    /**
     * @param {{answer: CellsAnswer | null, channel: string, from: string | null, corners: number,
     *   carried: number | null, hasPose: boolean, hasNeighbour: boolean, fault: string}} state
     */
    update({ answer, channel, from, corners, carried, hasPose, hasNeighbour, fault }) {
      find("cells-own").disabled = !hasPose;
      find("cells-neighbour").hidden = !hasNeighbour;
      find("cells-off").hidden = !from;
      for (const name of ["own", "corners", "neighbour"]) find(`cells-${name}`).setAttribute("aria-pressed", String(from === name));
      const waits = from === "corners" && corners < 4;
      const moved = carried === null ? "" :
        `The pose of frame ${carried}: where the camera has moved since, small cells lie elsewhere, and the largest tell.`;
      const hint = waits ? `Click the pad's corners in the large picture, one after the other: ${corners} of 4.` : moved;
      if (find("cells-hint").textContent !== hint) find("cells-hint").textContent = hint;
      find("cells-fault").textContent = fault;
      if (answer === shown && root.dataset.channel === channel) return;
      shown = answer;
      root.dataset.channel = channel;
      const layer = answer?.layers.find((each) => each.channel === channel) ?? null;
      find("cells-result").hidden = !layer;
      find("cells-verdicts").replaceChildren(...(answer?.layers ?? []).map((each) =>
        Object.assign(document.createElement("p"), { textContent: verdictOf(each, carried !== null) })));
      for (const input of find("cells-layers").querySelectorAll("input")) {
        input.parentElement.hidden = !answer?.layers.some((each) => each.channel === input.value);
        input.checked = input.value === channel;
      }
      find("cells-rows").replaceChildren(...(layer ? rowsOf(layer) : []));
      const rest = layer ? layer.wrong - MOST_ROWS : 0;
      find("cells-rest").textContent = layer && !layer.wrong ? "No cell is wrong." : rest > 0 ? `and ${rest} more` : "";
    },
  };
}
