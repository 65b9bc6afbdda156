/** The sessions that are open on the server besides this page's. */

import { sessionInWords } from "../liveLogic.js";

/**
 * @param {HTMLElement} root
 * @param {{onStop: (id: string) => void}} events
 */
export function mountSessionList(root, { onStop }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=list]"));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  let shown = "";

  /** @param {import("../../server/liveApi.js").Session} session */
  function row(session) {
    const item = /** @type {HTMLElement} */ (template.content.firstElementChild?.cloneNode(true));
    const find = (/** @type {string} */ name) => /** @type {any} */ (item.querySelector(`[data-ref=${name}]`));
    const words = sessionInWords(session);
    const [title, note] = [words.slice(0, words.indexOf(": ")), words.slice(words.indexOf(": ") + 2)];
    find("title").textContent = title;
    find("note").textContent = note;
    // A browser's camera can only be watched from where it is; a stream from everywhere.
    if (session.source !== "browser") find("open").href = `/live?session=${encodeURIComponent(session.id)}`;
    find("stop").setAttribute("aria-label", `Stop: ${title}`);
    find("stop").addEventListener("click", () => onStop(session.id));
    return item;
  }

  return {
    /** @param {import("../../server/liveApi.js").Session[]} sessions */
    update(sessions) {
      root.hidden = sessions.length === 0;
      const key = JSON.stringify(sessions.map(({ id, state, source }) => [id, state, source]));
      if (key === shown) return;
      shown = key;
      list.replaceChildren(...sessions.map(row));
    },
  };
}
