/** How a session fares: the answer to the page's question, and its figures. */

import { mountFacts } from "../../shared/components/facts.js";
import { factsOf, verdictOf } from "../liveLogic.js";

/** @param {HTMLElement} root */
export function mountFiguresPanel(root) {
  const verdict = /** @type {HTMLElement} */ (root.querySelector("[data-ref=verdict]"));
  const facts = mountFacts(/** @type {HTMLElement} */ (root.querySelector("[data-ref=facts]")));
  return {
    /** @param {{session: import("../../server/liveApi.js").Session | null}} state */
    update({ session }) {
      root.hidden = !session?.figures;
      if (!session?.figures) return;
      const { kind, text } = verdictOf(session.figures);
      verdict.className = kind === "quiet" ? "quiet" : `notice notice-${kind}`;
      if (verdict.textContent !== text) verdict.textContent = text;
      facts.update(factsOf(session));
    },
  };
}
