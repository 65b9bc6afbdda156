/**
 * One card a stage; the channels' pictures side by side, each opens enlarged.
 *
 * @typedef {import("../stagesLogic.js").StageCard} StageCard
 * @typedef {import("../stagesLogic.js").StageAnswer} StageAnswer
 * @typedef {import("../stagesLogic.js").Channel} Channel
 */

import { duration } from "../formatLogic.js";
import { reasonInWords } from "../stagesLogic.js";

/**
 * @param {HTMLElement} root  holds the list and the templates of a card and of a run
 * @param {{onOpen: (stage: string, channel: string | null) => void}} events
 */
export function mountStageGrid(root, { onOpen }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  const before = /** @type {HTMLElement} */ (root.querySelector("[data-ref=before]"));
  const after = /** @type {HTMLElement} */ (root.querySelector("[data-ref=after]"));
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
    part("channel").textContent = run.channel ?? "";
    part("channel").className = run.channel ? `channel channel-${run.channel}` : "";
    part("time").textContent = duration(run.elapsed_ms);
    part("failure").textContent = run.failure ? reasonInWords(run.failure.reason) : "";
    part("failure").title = run.failure?.detail ?? "";
    const open = /** @type {HTMLButtonElement} */ (part("open"));
    const image = /** @type {HTMLImageElement} */ (part("image"));
    if (run.picture) {
      image.src = run.thumbnail ?? run.picture;
      image.alt = "";
      open.setAttribute("aria-label", `Enlarge ${card.title}${run.channel ? `, ${run.channel}` : ""}`);
      open.dataset.stage = run.name;
      open.dataset.channel = run.channel ?? "";
      open.addEventListener("click", () => onOpen(run.name, run.channel));
    } else open.replaceWith(blank(run.failure ? "nothing found" : "no picture"));
    return element;
  }

  /** A channel that had failed before this stage. @param {string} channel */
  function unreached(channel) {
    const element = clone("run");
    const name = /** @type {HTMLElement} */ (element.querySelector("[data-ref=channel]"));
    name.textContent = channel;
    name.className = `channel channel-${channel}`;
    element.querySelector("[data-ref=open]")?.replaceWith(blank("not reached"));
    return element;
  }

  /** @param {StageCard} card @param {number} at @param {Channel[]} channels */
  function cardOf(card, at, channels) {
    const element = clone("card");
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (element.querySelector(`[data-ref=${name}]`));
    element.dataset.stage = card.name;
    element.toggleAttribute("data-failed", card.failed);
    part("number").textContent = String(at + 1);
    part("title").textContent = card.title;
    part("about").textContent = card.about;
    const wanted = isShared(card) ? [null] : channels;
    const runs = wanted.map((channel) => {
      const run = card.runs.find((each) => each.channel === channel);
      return run ? runOf(card, run) : unreached(channel ?? "");
    });
    part("runs").replaceChildren(...runs);
    return element;
  }

  return {
    /** @param {{cards: StageCard[], channels: Channel[]}} state */
    update({ cards, channels }) {
      root.hidden = !cards.length;
      if (cards === shown) return;
      shown = cards;
      list.dataset.channels = String(channels.length);
      const elements = cards.map((card, at) => cardOf(card, at, channels));
      const first = cards.findIndex((card) => !isShared(card));
      const group = (/** @type {(at: number) => boolean} */ belongs) =>
        elements.filter((_, at) => belongs(at));
      before.replaceChildren(...group((at) => isShared(cards[at]) && at < first));
      list.replaceChildren(...group((at) => !isShared(cards[at])));
      after.replaceChildren(...group((at) => isShared(cards[at]) && at > first));
    },
  };
}

/** A stage that serves all channels. @param {StageCard} card */
const isShared = (card) => card.runs.every((run) => run.channel === null);

/** What stands where there is no picture. @param {string} text */
const blank = (text) =>
  Object.assign(document.createElement("p"), { className: "stage-blank", textContent: text });
