/**
 * What the server's independent check of a pad says, as facts for a reader.
 *
 * @typedef {import("../server/answers.js").NearPair} NearPair
 * @typedef {import("../server/answers.js").Verification} Verification
 * @typedef {import("../server/answers.js").OtherLayer} OtherLayer
 * @typedef {import("../server/answers.js").LayersApart} LayersApart
 */

import { compact, number } from "../shared/formatLogic.js";

/**
 * @param {Verification | null} check  null where nothing was checked
 * @returns {{facts: [string, string][], fault: string, warning: string}}
 */
export function verificationFacts(check) {
  if (!check) return { facts: [], fault: "", warning: "" };
  const once = check.unique_under_rotation ? "in all rotations" : "as printed";
  /** @type {[string, string][]} */
  const facts = [
    ["Windows checked", number(check.windows)],
    ["Each occurs once", check.unique ? once : "no"],
  ];
  const least = leastDistance(check);
  if (typeof least === "number") facts.push(["Windows differ in", `≥ ${least} cells`]);
  if (check.unique && typeof least === "number") {
    facts.push(["Misreads corrected", number(Math.floor((least - 1) / 2))]);
  }
  if (check.windows_possible > 0) {
    const percent = (100 * check.windows) / check.windows_possible;
    facts.push(["Of all windows", percent < 0.001 ? "below 0.001 %" : `${compact(percent, 3)} %`]);
  }
  if (check.level_counts) {
    const cells = check.level_counts.reduce((sum, count) => sum + count, 0);
    const shares = check.level_counts.slice(0, 8).map((count) => number((100 * count) / cells, 1));
    facts.push(["Cells a level", `${shares.join(" : ")}${check.level_counts.length > 8 ? " …" : ""} %`]);
  }
  if (check.visible_lines !== undefined) {
    facts.push(["Inner lines", check.visible_lines ? "all visible" : "not all visible"]);
  }
  const others = check.others ?? [];
  for (const other of others) {
    const words = other.unique_under_rotation ? "in all rotations" : "as printed";
    const distance = `${words}, ≥ ${leastDistance(other)} cells`;
    facts.push([`The ${other.channel} layer's`, other.unique ? distance : "no"]);
  }
  const apart = check.apart ?? [];
  for (const pair of apart) {
    facts.push([apart.length > 1 ? `${pair.channels.join(" and ")} layers` : "The layers", apartInWords(pair)]);
  }
  const twice = [check, ...others].filter((each) => !each.unique);
  const places = twice.map((each) => `the ${each.channel ?? "red"} layer`).join(" and ");
  const faults = [
    ...(twice.length ? [`A window occurs twice in ${places}.`] : []),
    ...(check.broken?.length ? [`The pad's file promises what does not hold: ${check.broken.join("; ")}.`] : []),
  ];
  return { facts, fault: faults.join(" "), warning: apart.some(isShared) ? SHARED_COST : "" };
}

const SHARED_COST =
  "Layers share a code: whatever shows the fine pattern in the blue channel, or the coarse one in the red, " +
  "reads as another height, and the other channel alone tells which is right.";

/** @param {LayersApart} pair */
const isShared = (pair) => pair.relation === "shared";

/** @param {LayersApart} pair @returns {string} */
function apartInWords(pair) {
  if (isShared(pair)) {
    return `${number(pair.shared)} windows in both${pair.is_corner ? ": one copies the other's corner" : ""}`;
  }
  const word = pair.relation === "independent" ? "independent" : "nearer than windows of one layer";
  return `${word}, ≥\u00a0${pair.min_distance}\u00a0cells`;
}

/** @param {Verification | OtherLayer} check */
const leastDistance = (check) =>
  check.unique_under_rotation ? check.min_distance_under_rotation : check.min_distance;

/**
 * How many windows have their nearest other at each distance, in any turn where turned windows
 * differ, else as printed.
 * @param {Verification | null} check
 * @returns {{label: string, count: number, share: number}[]}  share of the highest bar
 */
export function histogramBars(check) {
  const turned = check?.unique_under_rotation ? check.histogram_under_rotation : check?.histogram;
  if (!turned?.length) return [];
  const most = Math.max(...turned, 1);
  return turned.map((count, distance) => ({
    label: distance < turned.length - 1 ? String(distance) : `≥ ${distance}`,
    count,
    share: count / most,
  }));
}

/**
 * @param {NearPair} pair
 * @returns {string}
 */
export function pairInWords({ row, col, other_row: otherRow, other_col: otherCol, turn, distance }) {
  const turned = turn ? `, turned by ${90 * turn}°` : "";
  const other = row === otherRow && col === otherCol ? "itself" : `${otherRow}, ${otherCol}`;
  return `${row}, ${col} and ${other}${turned}: ${distance} ${distance === 1 ? "cell" : "cells"}`;
}
