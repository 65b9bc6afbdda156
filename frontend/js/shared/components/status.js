/**
 * One line that says what happened; screen readers hear it.
 *
 * @typedef {{kind: "ok" | "warn" | "bad" | "quiet", text: string, again?: () => void} | null} Status
 *   with a button that tries `again`, where that may help
 */

import { isPassing, messageOf } from "../../server/request.js";

/**
 * What a page has to load did not come.
 * @param {unknown} error
 * @param {() => void} [again]  else the page is loaded anew, which keeps what its address tells
 * @returns {Status}
 */
export const loadFault = (error, again = () => location.reload()) => ({
  kind: "bad", text: messageOf(error), ...(isPassing(error) ? { again } : {}),
});

/**
 * @param {HTMLElement} element  with `role="status"`
 * @returns {{update: (status: Status) => void}}
 */
export function mountStatus(element) {
  /** @type {Status} */
  let shown = null;
  const button = document.createElement("button");
  [button.className, button.type, button.textContent] = ["button", "button", "Try again"];
  button.addEventListener("click", () => shown?.again?.());
  return {
    update(status) {
      element.className = status && status.kind !== "quiet" ? `notice notice-${status.kind}` : "quiet";
      const isOther = status?.text !== shown?.text || Boolean(status?.again) !== Boolean(shown?.again);
      shown = status;
      if (isOther) element.replaceChildren(...(status ? [status.text] : []), ...(status?.again ? [" ", button] : []));
    },
  };
}
