/**
 * What every page that reads pictures lets its user choose: a pad, a camera, a method.
 *
 * @typedef {object} ReadingChoice
 * @property {import("../server/api.js").PadSummary[]} pads  to choose from
 * @property {import("../server/api.js").CameraSummary[]} stored  cameras to choose from
 * @property {import("../server/api.js").CameraSummary[]} presets
 * @property {string} pad  chosen id; empty: none yet
 * @property {string[]} others  ids of more pads that may be in view
 * @property {string} camera  chosen id; empty: none yet
 * @property {string} method
 */

/**
 * The choices that an address holds, before the lists are there.
 * @param {URLSearchParams} address
 * @returns {ReadingChoice}
 */
export const readingChoiceFrom = (address) => ({
  pads: [],
  stored: [],
  presets: [],
  pad: address.get("pad") ?? "",
  others: (address.get("others") ?? "").split(",").filter(Boolean),
  camera: address.get("camera") ?? "",
  method: address.get("method") === "paper" ? "paper" : "dense",
});
