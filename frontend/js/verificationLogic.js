/**
 * What the server's independent check of a pad says, as facts for a reader.
 */

import { number } from "./formatLogic.js";

/**
 * Every plain figure of the check, named after its key; nested objects (one a layer) are opened.
 * @param {Record<string, unknown> | null} verification
 * @returns {{facts: [string, string][], fault: string}}
 */
export function verificationFacts(verification) {
  if (!verification) return { facts: [], fault: "" };
  /** @type {[string, string][]} */
  const facts = [];
  const walk = (/** @type {Record<string, unknown>} */ node, /** @type {string} */ prefix) => {
    for (const [key, value] of Object.entries(node)) {
      const term = [prefix, words(key)].filter(Boolean).join(" ");
      if (value !== null && typeof value === "object" && !Array.isArray(value)) {
        walk(/** @type {Record<string, unknown>} */ (value), term);
      } else if (typeof value === "number") facts.push([term, number(value)]);
      else if (typeof value === "boolean") facts.push([term, value ? "yes" : "no"]);
    }
  };
  walk(verification, "");
  const failed = verification.ok === false || verification.unique === false;
  return { facts, fault: failed ? "The check found a window that occurs twice." : "" };
}

/** @param {string} key @returns {string} */
function words(key) {
  const text = key.replaceAll("_", " ");
  return text.charAt(0).toUpperCase() + text.slice(1);
}
