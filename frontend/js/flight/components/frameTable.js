/**
 * The frames of a flight as a table, page by page, narrowed by what became of them.
 *
 * @typedef {import("../frameTableLogic.js").Filter} Filter
 * @typedef {import("../frameTableLogic.js").TablePage} TablePage
 */

import { filterFault, noFilter, rowOf } from "../frameTableLogic.js";
import { reasonInWords } from "../../shared/stagesLogic.js";
import { keyedRows } from "../../shared/components/keyedRows.js";

const MM_PER_M = 1000;
const TYPING_MS = 300;
/** The fields of a filter and by what their figures are multiplied. */
const NUMBERS = /** @type {const} */ ([
  ["from_s", 1], ["to_s", 1], ["min_height", MM_PER_M], ["max_height", MM_PER_M],
]);
const TEXTS = /** @type {const} */ (["status", "reason", "layer", "quality"]);

/**
 * @param {HTMLDetailsElement} root
 * @param {{onFilter: (filter: Filter | null) => void, onTurn: (by: 1 | -1) => void,
 *   onSeek: (frame: number) => void}} events  a filter of null closes the table
 */
export function mountFrameTable(root, { onFilter, onTurn, onSeek }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const any = find("reason").options[0];
  let typing = 0;
  let reasons = "";
  /** @type {number | null} */
  let followed = null;
  const rows = keyedRows(find("rows"), /** @type {HTMLTemplateElement} */ (root.querySelector("template")), {
    make: (part, key) => part("frame").addEventListener("click", () => onSeek(Number(key))),
    fill: (part, element, { row }) => {
      element.dataset.current = String(row.current);
      element.dataset.kind = row.kind;
      part("frame").setAttribute("aria-current", String(row.current));
      for (const name of ["frame", "time", "outcome", "height", "place", "detail"]) {
        part(name).textContent = row[name];
      }
      part("detail").title = row.detail;
    },
  });
  root.addEventListener("toggle", () => onFilter(root.open ? read() : null));
  find("filter").addEventListener("input", () => {
    window.clearTimeout(typing);
    typing = window.setTimeout(() => onFilter(read()), TYPING_MS);
  });
  find("filter").addEventListener("submit", (/** @type {Event} */ event) => event.preventDefault());
  find("clear").addEventListener("click", () => {
    write(noFilter());
    onFilter(noFilter());
  });
  find("earlier").addEventListener("click", () => onTurn(-1));
  find("later").addEventListener("click", () => onTurn(1));
  find("rows").addEventListener("keydown", onKey);

  /** Up and down go from frame to frame. @param {KeyboardEvent} event */
  function onKey(event) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    const buttons = [...find("rows").querySelectorAll("button")];
    const next = by && buttons[buttons.indexOf(document.activeElement) + by];
    if (!next) return;
    event.preventDefault();
    next.focus();
    next.click();
  }

  /** @returns {Filter} */
  function read() {
    const filter = noFilter();
    for (const name of TEXTS) filter[name] = find(name).value;
    for (const [name, scale] of NUMBERS) {
      const value = find(name).valueAsNumber;
      filter[name] = Number.isFinite(value) ? value * scale : null;
    }
    return filter;
  }

  /** @param {string} reason */
  function writeReason(reason) {
    const isKnown = [...find("reason").options].some((option) => option.value === reason);
    // From the address, before the flight's own reasons are there.
    if (!isKnown) find("reason").append(new Option(reasonInWords(reason), reason));
    find("reason").value = reason;
  }

  /** @param {Filter} filter */
  function write(filter) {
    writeReason(filter.reason);
    for (const name of TEXTS) find(name).value = filter[name];
    for (const [name, scale] of NUMBERS) {
      const value = filter[name];
      find(name).value = value === null ? "" : String(value / scale);
    }
  }

  /** Scrolls the table, and never the page. */
  function showCurrent() {
    const row = find("rows").querySelector("[data-current=true]");
    if (!row) return;
    const area = find("table");
    const head = area.querySelector("thead").offsetHeight;
    area.scrollTop = Math.min(area.scrollTop, row.offsetTop - head);
    area.scrollTop = Math.max(area.scrollTop, row.offsetTop + row.offsetHeight - area.clientHeight);
  }

  /** @param {{reason: string, text: string}[]} list @param {Filter | null} filter */
  function fillReasons(list, filter) {
    const key = JSON.stringify(list);
    if (key === reasons) return;
    reasons = key;
    const chosen = root.open ? find("reason").value : (filter?.reason ?? "");
    find("reason").replaceChildren(any, ...list.map(({ reason, text }) => new Option(text, reason)));
    // What is being typed elsewhere stays.
    writeReason(chosen);
  }

  return {
    /** @param {{filter: Filter | null, page: TablePage | null, frame: number | null,
     *   reasons: {reason: string, text: string}[]}} state */
    update({ filter, page, frame, reasons: list }) {
      fillReasons(list, filter);
      if (filter && !root.open) {
        write(filter);
        root.open = true;
      }
      const items = page?.items ?? [];
      rows.update(items.map((record) => ({ key: String(record.frame), row: rowOf(record, frame) })));
      const fault = filter ? filterFault(filter) : "";
      find("fault").textContent = fault;
      find("empty").hidden = !page || items.length > 0 || Boolean(fault);
      find("table").hidden = !items.length;
      find("earlier").disabled = !page?.earlier;
      find("later").disabled = !page?.later;
      if (frame !== followed && items.some((record) => record.frame === frame)) {
        followed = frame;
        showCurrent();
      }
      const last = items[items.length - 1];
      find("shown").textContent = last ? `frames ${items[0].frame} to ${last.frame}` : "";
    },
  };
}
