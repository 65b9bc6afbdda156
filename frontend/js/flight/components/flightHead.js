/**
 * The head of a flight's page: name, state, progress, what can be done.
 *
 * @typedef {import("../../server/flightsApi.js").Flight} Flight
 */

import { flightNotes, isRetryable } from "../flightLogic.js";
import { isOpen } from "../../server/flightsApi.js";
import { progressInWords, restInWords, stateInWords } from "../../shared/flightStateLogic.js";

/**
 * @param {HTMLElement} root
 * @param {{onCancel: () => void, onRetry: () => void, onRerun: () => void}} events
 */
export function mountFlightHead(root, { onCancel, onRetry, onRerun }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  find("cancel").addEventListener("click", onCancel);
  find("retry").addEventListener("click", onRetry);
  find("rerun").addEventListener("click", onRerun);
  const write = (/** @type {string} */ name, /** @type {string} */ text) => {
    if (find(name).textContent !== text) find(name).textContent = text;
  };

  let notesShown = "";

  return {
    /** @param {{flight: Flight | null, now: number}} state */
    update({ flight, now }) {
      for (const name of ["progress", "rerun"]) find(name).hidden = !flight;
      if (!flight) return;
      root.dataset.state = flight.state;
      write("name", flight.name);
      write("state", stateInWords(flight));
      write("done", progressInWords(flight));
      write("rest", restInWords(flight, now));
      write("error", flight.error?.message ?? "");
      const bar = /** @type {HTMLProgressElement} */ (find("bar"));
      bar.hidden = flight.state === "done";
      bar.value = flight.progress;
      find("cancel").hidden = !isOpen(flight);
      find("retry").hidden = !isRetryable(flight);
      const notes = flightNotes(flight);
      if (notes.join("\n") !== notesShown) {
        notesShown = notes.join("\n");
        find("notes").replaceChildren(
          ...notes.map((textContent) =>
            Object.assign(document.createElement("p"), { className: "notice notice-warn", textContent }),
          ),
        );
      }
    },
  };
}
