/**
 * One line that says what happened; screen readers hear it.
 *
 * @typedef {{kind: "ok" | "warn" | "bad" | "quiet", text: string} | null} Status
 */

/**
 * @param {HTMLElement} element  with `role="status"`
 * @returns {{update: (status: Status) => void}}
 */
export function mountStatus(element) {
  return {
    update(status) {
      const text = status?.text ?? "";
      element.className = status && status.kind !== "quiet" ? `notice notice-${status.kind}` : "quiet";
      if (element.textContent !== text) element.textContent = text;
    },
  };
}
