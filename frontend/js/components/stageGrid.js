/**
 * One card a stage; the channels' pictures side by side, each opens enlarged.
 *
 * @typedef {import("../stagesLogic.js").StageCard} StageCard
 * @typedef {import("../stagesLogic.js").StageAnswer} StageAnswer
 */

import { duration } from "../formatLogic.js";
import { reasonInWords } from "../stagesLogic.js";

/**
 * @param {HTMLElement} root  holds the list and the templates of a card and of a run
 * @param {{onOpen: (stage: string, channel: string | null) => void}} events
 */
export function mountStageGrid(root, { onOpen }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  /** @type {StageCard[] | null} */
  let shown = null;

  /** @param {string} name @returns {HTMLElement} */
  function clone(name) {
    const template = /** @type {HTMLTemplateElement} */ (root.querySelector(`template[data-ref=${name}]`));
    const fragment = /** @type {DocumentFragment} */ (template.content.cloneNode(true));
    return /** @type {HTMLElement} */ (fragment.firstElementChild);
  }

  /** @param {StageCard} card @param {StageAnswer} run */
  function runOf(card, run) {
    const element = clone("run");
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (element.querySelector(`[data-ref=${name}]`));
    element.toggleAttribute("data-failed", Boolean(run.failure));
    part("channel").textContent = run.channel ?? "both channels";
    part("channel").className = run.channel ? `channel channel-${run.channel}` : "quiet";
    part("time").textContent = duration(run.elapsed_ms);
    part("failure").textContent = run.failure ? reasonInWords(run.failure.reason) : "";
    part("failure").title = run.failure?.detail ?? "";
    const open = /** @type {HTMLButtonElement} */ (part("open"));
    const image = /** @type {HTMLImageElement} */ (part("image"));
    if (run.picture) {
      image.src = run.thumbnail ?? run.picture;
      image.alt = "";
      open.setAttribute("aria-label", `Enlarge ${card.title}, ${run.channel ?? "both channels"}`);
      open.dataset.stage = run.name;
      open.dataset.channel = run.channel ?? "";
      open.addEventListener("click", () => onOpen(run.name, run.channel));
    } else {
      open.replaceWith(Object.assign(document.createElement("p"), {
        className: "stage-blank",
        textContent: run.failure ? "nothing found" : "no picture",
      }));
    }
    return element;
  }

  /** @param {StageCard} card @param {number} at */
  function cardOf(card, at) {
    const element = clone("card");
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (element.querySelector(`[data-ref=${name}]`));
    element.dataset.stage = card.name;
    element.toggleAttribute("data-failed", card.failed);
    part("number").textContent = String(at + 1);
    part("title").textContent = card.title;
    part("about").textContent = card.about;
    part("runs").replaceChildren(...card.runs.map((run) => runOf(card, run)));
    return element;
  }

  return {
    /** @param {{cards: StageCard[]}} state */
    update({ cards }) {
      root.hidden = !cards.length;
      if (cards === shown) return;
      shown = cards;
      list.replaceChildren(...cards.map(cardOf));
    },
  };
}
