/**
 * The panel of a bundle that was opened: its results then and now, what differs, the frames beside.
 *
 * @typedef {import("../server/bundleApi.js").Bundle} Bundle
 */

import { neighbourTitle, rowsOf, shownNote, valueInWords, verdictOf, versionsInWords } from "./bundleLogic.js";

const SMALL_PX = 320;

/** @param {HTMLElement} root */
export function mountBundlePanel(root) {
  const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  /** @type {Bundle | null} */
  let shown = null;

  /** @param {Bundle} bundle */
  function fill(bundle) {
    const rows = rowsOf(bundle);
    const verdict = find("verdict");
    verdict.textContent = verdictOf(bundle);
    verdict.className = `notice notice-${bundle.same ? "ok" : "warn"}`;
    find("results").replaceChildren(...rows.map(({ name, then, now, differences }) =>
      tableRow([name, then, now, differences.length ? String(differences.length) : "none"])));
    const fields = rows.flatMap(({ name, differences }) =>
      differences.map(({ field, then, now }) => tableRow([name, field, valueInWords(then), valueInWords(now)])));
    find("fields").hidden = !fields.length;
    find("fields-title").textContent = `${fields.length} ${fields.length === 1 ? "field differs" : "fields differ"}`;
    find("differences").replaceChildren(...fields);
    find("shown").textContent = shownNote(bundle);
    find("versions").textContent = versionsInWords(bundle);
    find("neighbours").replaceChildren(...bundle.neighbours.map(figureOf));
  }

  return {
    /** @param {Bundle | null} bundle */
    update(bundle) {
      root.hidden = !bundle;
      if (bundle && bundle !== shown) fill(bundle);
      shown = bundle;
    },
  };
}

/** @param {string[]} texts  the first one heads the row */
function tableRow([head, ...texts]) {
  const row = document.createElement("tr");
  const first = Object.assign(document.createElement("th"), { scope: "row", textContent: head });
  row.append(first, ...texts.map((textContent) => Object.assign(document.createElement("td"), { textContent })));
  return row;
}

/** @param {Bundle["neighbours"][number]} neighbour */
function figureOf(neighbour) {
  const figure = document.createElement("figure");
  const title = neighbourTitle(neighbour);
  if (neighbour.picture) {
    const link = Object.assign(document.createElement("a"), { href: neighbour.picture, target: "_blank" });
    link.append(Object.assign(document.createElement("img"), { src: `${neighbour.picture}?width=${SMALL_PX}`, alt: title }));
    figure.append(link);
  }
  figure.append(Object.assign(document.createElement("figcaption"), { className: "quiet", textContent: title }));
  return figure;
}
