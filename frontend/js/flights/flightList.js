/**
 * The flights, each with its progress and a link to its page.
 *
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 */

import { isOpen } from "../server/flightsApi.js";
import { progressInWords, restInWords, stateInWords } from "../shared/flightStateLogic.js";
import { moment, number } from "../shared/formatLogic.js";
import { keyedRows } from "../shared/components/keyedRows.js";
import { methodInWords } from "../shared/readingLogic.js";

/**
 * @param {HTMLElement} root
 * @param {{onCancel: (id: string) => void, onRemove: (flight: Flight) => void, onMore: () => void}} events
 */
export function mountFlightList(root, { onCancel, onRemove, onMore }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  /** @type {Flight[]} */
  let shown = [];
  find("more").addEventListener("click", onMore);
  const list = keyedRows(find("list"), /** @type {HTMLTemplateElement} */ (root.querySelector("template")), {
    make: (part, key) => {
      part("act").addEventListener("click", () => {
        const flight = shown.find((each) => each.id === key);
        if (flight) isOpen(flight) ? onCancel(key) : onRemove(flight);
      });
    },
    fill: (part, element, { flight, rest }) => {
      element.dataset.state = flight.state;
      /** @type {HTMLAnchorElement} */ (part("open")).href = `/flights/${flight.id}`;
      part("title").textContent = part("title").title = flight.name;
      part("state").textContent = stateInWords(flight);
      part("note").textContent = flight.error?.message ?? flight.notice ?? progressInWords(flight);
      const { pad_name: pad, method } = flight.request;
      part("about").textContent = rest || [pad, methodInWords(method), moment(flight.created_at)].filter(Boolean).join(" · ");
      const bar = /** @type {HTMLProgressElement} */ (part("bar"));
      bar.hidden = flight.state === "done";
      bar.value = flight.progress;
      bar.setAttribute("aria-label", `${flight.name}, read`);
      const compare = /** @type {HTMLAnchorElement} */ (part("compare"));
      compare.hidden = !flight.rerun_of || flight.state !== "done";
      compare.href = `/flights/${flight.id}?with=${flight.rerun_of}`;
      const verb = isOpen(flight) ? "Cancel" : "Remove";
      part("act").textContent = verb;
      part("act").setAttribute("aria-label", `${verb} ${flight.name}`);
    },
  });

  return {
    /** @param {{flights: Flight[], total: number | null, now: number}} state */
    update({ flights, total, now }) {
      shown = flights;
      list.update(flights.map((flight) => ({ key: flight.id, flight, rest: restInWords(flight, now) })));
      find("empty").hidden = total !== 0;
      find("more").hidden = total === null || flights.length >= total;
      const open = flights.filter(isOpen).length;
      const text = total ? `${number(total)} in all${open ? `, ${number(open)} at work` : ""}` : "";
      if (find("tally").textContent !== text) find("tally").textContent = text;
    },
  };
}
