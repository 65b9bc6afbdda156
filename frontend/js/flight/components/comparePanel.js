/**
 * This run beside another: counts, a strip, the frame that is looked at with both poses, the changes.
 *
 * @typedef {import("../../server/flightsApi.js").Change} Change
 * @typedef {import("../../server/flightsApi.js").Comparison} Comparison
 *
 * @typedef {object} CompareState
 * @property {import("../../server/flightsApi.js").Flight | null} flight
 * @property {import("../../server/flightsApi.js").Flight | null} other  null: none is compared
 * @property {number | null} frame
 * @property {import("./framePainter.js").Picture | null} picture
 * @property {import("../../server/flightsApi.js").OutlineLine[]} lines  of this run's pose
 */

import { compareFlights, getOutlines, listChanges } from "../../server/flightsApi.js";
import { messageOf } from "../../server/request.js";
import { keyedRows } from "../../shared/components/keyedRows.js";
import { mountPlot } from "../../shared/components/plot.js";
import { changeInWords, changesChart, comparisonInWords, figuresOf, LEAST_MM, resultInWords } from "../compareLogic.js";
import { pageOf, placeBeside } from "../frameTableLogic.js";
import { paintFrame } from "./framePainter.js";

const COLUMNS = 200;
const ROWS = 50;
// A frame that is only passed is not asked for.
const REST_MS = 200;

/**
 * @param {HTMLElement} root
 * @param {string} id  of this run
 * @param {{onSeek: (frame: number) => void}} events
 */
export function mountComparePanel(root, id, { onSeek }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const strip = mountPlot(find("strip"), { onFrame: onSeek });
  /** @type {CompareState} */
  let state = { flight: null, other: null, frame: null, picture: null, lines: [] };
  let asked = "";
  let timer = 0;
  let pairTimer = 0;
  /** @type {{frame: number, change: Change | null, lines: CompareState["lines"]} | null} */
  let pair = null;
  /** @type {{items: Change[], earlier: boolean, later: boolean}} */
  let page = { items: [], earlier: false, later: false };

  const rows = keyedRows(find("rows"), find("row"), {
    make: (part, key) => part("frame").addEventListener("click", () => onSeek(Number(key))),
    fill: (part, element, { change, current }) => {
      const { kind, word } = changeInWords(change);
      element.dataset.kind = kind;
      element.dataset.current = String(current);
      const texts = { frame: change.frame, change: word, ...figuresOf(change), own: resultInWords(change.own), other: resultInWords(change.other) };
      for (const [name, text] of Object.entries(texts)) part(name).textContent = text;
    },
  });

  /** @param {() => Promise<void>} ask */
  async function careful(ask) {
    find("fault").textContent = "";
    try {
      await ask();
    } catch (error) {
      find("fault").textContent = messageOf(error);
    }
  }

  /** @param {{after?: number, before?: number}} place */
  const fetchPage = (place) => careful(async () => {
    const { other } = state;
    if (!other) return;
    const kind = find("kind").value;
    const answer = await listChanges(id, other.id, { ...(kind ? { kind } : {}), least_mm: LEAST_MM, ...place, limit: ROWS });
    if (other.id !== state.other?.id) return;
    page = pageOf(answer, place, ROWS);
    render();
  });

  const fetchAll = () => careful(async () => {
    const { other } = state;
    if (!other) return;
    const found = await compareFlights(id, other.id, COLUMNS);
    if (other.id !== state.other?.id) return;
    find("words").replaceChildren(...comparisonInWords(found).map((textContent) => Object.assign(document.createElement("p"), { textContent })));
    strip.show((colour) => changesChart(found, colour));
    await fetchPage({});
  });

  /** What both runs have of the frame that is looked at. */
  const fetchPair = () => careful(async () => {
    const { other, frame } = state;
    if (!other || frame === null) return;
    const place = { after: frame - 1, limit: 1 };
    const [{ items }, outlines] = await Promise.all([
      listChanges(id, other.id, place), getOutlines(other.id, { first_frame: frame, limit: 1 }),
    ]);
    if (frame !== state.frame || other.id !== state.other?.id) return;
    const change = items[0]?.frame === frame ? items[0] : null;
    pair = { frame, change, lines: outlines.items[0]?.frame === frame ? outlines.items[0].lines : [] };
    render();
  });

  /** The next frame that changed, or the one before. @param {1 | -1} by */
  const go = (by) => careful(async () => {
    const { other, frame } = state;
    if (!other) return;
    const from = frame ?? -1;
    const place = by > 0 ? { after: from } : { before: Math.max(from, 0) };
    const kind = find("kind").value || "changed";
    const { items } = await listChanges(id, other.id, { kind, least_mm: LEAST_MM, ...place, limit: 1 });
    if (items.length) onSeek(items[0].frame);
    else find("fault").textContent = `No ${by > 0 ? "later" : "earlier"} frame changed so.`;
  });

  function render() {
    const { other, frame, picture } = state;
    root.hidden = !other;
    if (!other) return;
    find("title").textContent = `Compared with ${other.name}`;
    rows.update(page.items.map((change) => ({ key: String(change.frame), change, current: change.frame === frame })));
    find("empty").hidden = page.items.length > 0;
    find("table").hidden = !page.items.length;
    find("earlier").disabled = !page.earlier;
    find("later").disabled = !page.later;
    const isThere = pair !== null && pair.frame === frame;
    const change = isThere ? pair?.change : null;
    find("pair-words").textContent = change ? pairInWords(change) : "";
    const sides = /** @type {const} */ ([["own", state.lines], ["other", isThere ? (pair?.lines ?? []) : []]]);
    for (const [name, lines] of sides) {
      const record = change?.[name];
      find(`${name}-result`).textContent = record ? resultInWords(record) : "not read";
      const canvas = find(`${name}-picture`);
      if (picture) paintFrame(canvas, canvas.parentElement.clientWidth, picture, record ? lines : []);
    }
  }

  find("kind").addEventListener("change", () => void fetchPage({}));
  find("earlier").addEventListener("click", () => void fetchPage(placeBeside(page, -1)));
  find("later").addEventListener("click", () => void fetchPage(placeBeside(page, 1)));
  find("next").addEventListener("click", () => void go(1));
  find("previous").addEventListener("click", () => void go(-1));
  document.addEventListener("keydown", (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    const isCommand = event.ctrlKey || event.metaKey || event.altKey;
    if (!state.other || isCommand || event.key.toLowerCase() !== "c" || document.querySelector("dialog[open]")) return;
    if (target.matches("input:not([type=radio]), select, textarea")) return;
    void go(event.shiftKey ? -1 : 1);
  });
  new ResizeObserver(render).observe(find("pair"));

  return {
    /** @param {CompareState} next */
    update(next) {
      const isOtherFrame = next.frame !== state.frame || next.other?.id !== state.other?.id;
      state = next;
      const { flight, other } = next;
      // Before a run's files were looked into there is nothing to compare.
      const areKnown = flight?.frames_total && other?.frames_total;
      const key = areKnown ? [other.id, flight.state, flight.frames_done, other.frames_done].join() : "";
      if (key !== asked) {
        asked = key;
        window.clearTimeout(timer);
        if (key) timer = window.setTimeout(() => void fetchAll(), REST_MS);
      }
      if (areKnown && isOtherFrame) {
        window.clearTimeout(pairTimer);
        pairTimer = window.setTimeout(() => void fetchPair(), REST_MS);
      }
      render();
    },
  };
}

/** @param {Change} change */
function pairInWords(change) {
  const { word } = changeInWords(change);
  const { moved, share, turned } = figuresOf(change);
  const apart = moved ? `: ${[moved, share && `${share} of the distance`, turned].filter(Boolean).join(", ")} apart` : "";
  return `Frame ${change.frame}, ${word}${apart}`;
}
