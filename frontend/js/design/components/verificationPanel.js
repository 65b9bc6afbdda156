/**
 * What the check of a pad found: facts, distances as bars, the weakest windows to look at.
 *
 * @typedef {import("../verificationLogic.js").Verification} Verification
 * @typedef {import("../verificationLogic.js").NearPair} NearPair
 */

import { number } from "../../shared/formatLogic.js";
import { histogramBars, pairInWords, verificationFacts } from "../verificationLogic.js";
import { mountFacts } from "../../shared/components/facts.js";
import { draw, titled } from "./svg.js";

const CHART = { width: 240, height: 96, foot: 16, head: 14, gap: 4 };

/**
 * @param {HTMLElement} root
 * @param {{onPair: (place: number | null) => void}} events  which of the weakest is looked at
 */
export function mountVerificationPanel(root, { onPair }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  const facts = mountFacts(find("facts"));
  const list = find("weakest");
  const svg = find("histogram");
  svg.setAttribute("viewBox", `0 0 ${CHART.width} ${CHART.height}`);
  /** @type {Verification | null} */
  let shown = null;
  let chosen = /** @type {number | null} */ (null);

  /** @param {NearPair} pair @param {number} place */
  function row(pair, place) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "pair figure";
    button.textContent = pairInWords(pair);
    button.addEventListener("click", () => onPair(chosen === place ? null : place));
    const item = document.createElement("li");
    item.append(button);
    return item;
  }

  return {
    /** @param {{check: Verification | null, pair: number | null, busy: boolean}} state */
    update({ check, pair, busy }) {
      root.hidden = !check && !busy;
      find("busy").hidden = !busy;
      if (check !== shown) {
        shown = check;
        const { facts: found, fault, warning } = verificationFacts(check);
        facts.update(found);
        find("fault").textContent = fault;
        find("warning").textContent = warning;
        svg.replaceChildren(...bars(check));
        list.replaceChildren(...(check?.weakest ?? []).map(row));
        find("distances").hidden = !histogramBars(check).length;
        find("weakest-part").hidden = !check?.weakest?.length;
      }
      chosen = pair;
      [...list.querySelectorAll("button")].forEach((button, place) => {
        button.setAttribute("aria-pressed", String(place === pair));
      });
    },
  };
}

/** @param {Verification | null} check @returns {SVGElement[]} */
function bars(check) {
  const found = histogramBars(check);
  const step = CHART.width / Math.max(found.length, 1);
  const room = CHART.height - CHART.foot - CHART.head;
  return found.flatMap(({ label, count, share }, place) => {
    // A count of a few among thousands must still be seen.
    const height = count ? Math.max(1.5, room * share) : 0;
    const x = place * step;
    const top = CHART.height - CHART.foot - height;
    const middle = x + step / 2;
    const box = { x: x + CHART.gap / 2, y: top, width: step - CHART.gap, height };
    return [
      titled(draw("rect", { ...box, class: "bar-box" }), `${number(count)} windows, the nearest other ${label} cells off`),
      draw("text", { x: middle, y: top - 4, class: "bar-count" }, number(count)),
      draw("text", { x: middle, y: CHART.height - 4, class: "bar-label" }, label),
    ];
  });
}
