/**
 * What the server's independent check of a pad says, as facts for a reader.
 *
 * @typedef {object} Verification
 * @property {number} windows
 * @property {boolean} unique
 * @property {boolean} unique_under_rotation
 * @property {number | null} [min_distance]
 * @property {number | null} [min_distance_under_rotation]
 */

import { number } from "./formatLogic.js";

/**
 * @param {Verification | null} check  null where nothing was checked
 * @returns {{facts: [string, string][], fault: string}}
 */
export function verificationFacts(check) {
  if (!check) return { facts: [], fault: "" };
  const once = check.unique_under_rotation ? "in all rotations" : "as printed";
  /** @type {[string, string][]} */
  const facts = [
    ["Windows checked", number(check.windows)],
    ["Each occurs once", check.unique ? once : "no"],
  ];
  const least = check.unique_under_rotation ? check.min_distance_under_rotation : check.min_distance;
  if (typeof least === "number") facts.push(["Windows differ in", `${least} or more cells`]);
  return { facts, fault: check.unique ? "" : "The check found a window that occurs twice." };
}
