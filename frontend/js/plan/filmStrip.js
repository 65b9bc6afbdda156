/**
 * Simulated pictures: one large with its truth, the others small below it.
 *
 * @typedef {object} Shot
 * @property {string} words  where it was taken from
 * @property {string | null} url  null while it is being taken
 * @property {[string, string][]} truth
 */

import { mountFacts } from "../shared/components/facts.js";

/**
 * @param {HTMLElement} root
 * @param {{onChoose: (place: number) => void}} events
 */
export function mountFilmStrip(root, { onChoose }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  const large = /** @type {HTMLImageElement} */ (find("large"));
  const list = find("shots");
  const facts = mountFacts(find("truth"));
  let shown = "";

  /** @param {Shot} shot @param {number} place */
  function thumbnail(shot, place) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "shot";
    button.addEventListener("click", () => onChoose(place));
    const picture = document.createElement("span");
    picture.className = "shot-picture";
    if (shot.url) picture.append(Object.assign(new Image(), { src: shot.url, alt: "" }));
    const words = document.createElement("span");
    words.className = "shot-words figure";
    words.textContent = shot.words;
    button.append(picture, words);
    const item = document.createElement("li");
    item.append(button);
    return item;
  }

  return {
    /** @param {{shots: Shot[], chosen: number}} state */
    update({ shots, chosen }) {
      root.hidden = !shots.length;
      const key = JSON.stringify(shots.map(({ words, url }) => [words, url]));
      if (key !== shown) {
        shown = key;
        list.replaceChildren(...shots.map(thumbnail));
      }
      list.hidden = shots.length < 2;
      [...list.querySelectorAll("button")].forEach((button, place) => {
        button.setAttribute("aria-pressed", String(place === chosen));
      });
      const shot = shots[chosen];
      const url = shot?.url ?? "";
      if (large.getAttribute("src") !== url) {
        if (url) large.src = url;
        else large.removeAttribute("src");
      }
      large.hidden = !url;
      large.alt = shot ? `Simulated picture from ${shot.words}` : "";
      facts.update(shot?.truth ?? []);
    },
  };
}
