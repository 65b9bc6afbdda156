/**
 * The section of one kind of experiment: its form, how far it is, what was kept, the report.
 *
 * @typedef {import("../../server/experimentsApi.js").Experiment} Experiment
 * @typedef {import("../../server/experimentsApi.js").ExperimentDetail} ExperimentDetail
 *
 * @typedef {object} SectionState
 * @property {Experiment[]} all  of its kind, newest first
 * @property {ExperimentDetail | null} opened  whose report is shown
 * @property {boolean} isOrdering
 * @property {import("../../shared/components/status.js").Status} status
 */

import { keyedRows } from "../../shared/components/keyedRows.js";
import { mountStatus } from "../../shared/components/status.js";
import { isAtWork, noteOf, progressInWords, reportInWords } from "../experimentLogic.js";
import { mountReportView } from "./reportView.js";

/**
 * @param {HTMLElement} root  made by `templates/parts/experiment.html`
 * @param {{onStart: () => void, onOpen: (id: string) => void, onRemove: (id: string) => void}} events
 */
export function mountExperimentSection(root, { onStart, onOpen, onRemove }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const status = mountStatus(find("status"));
  const report = mountReportView(find("report"));
  const list = keyedRows(find("list"), find("template"), {
    make: (part, key) => {
      part("open").addEventListener("click", () => onOpen(key));
      part("remove").addEventListener("click", () => onRemove(key));
    },
    fill: (part, element, row) => {
      part("title").textContent = row.name;
      part("note").textContent = row.note;
      element.dataset.current = String(row.isOpen);
      /** @type {HTMLButtonElement} */ (part("open")).disabled = !row.isDone;
      part("remove").textContent = row.isAtWork ? "Stop" : "Forget";
      part("remove").setAttribute("aria-label", `${row.isAtWork ? "Stop" : "Forget"} ${row.name}, ${row.note}`);
    },
  });
  find("form").addEventListener("submit", (/** @type {Event} */ event) => {
    event.preventDefault();
    onStart();
  });

  return {
    /** @param {SectionState} state */
    update({ all, opened, isOrdering, status: said }) {
      find("start").disabled = isOrdering;
      list.update(all.map((each) => ({
        key: each.id, name: each.name, note: noteOf(each), isAtWork: isAtWork(each), isDone: each.state === "done",
        isOpen: opened?.id === each.id,
      })));
      find("blank").hidden = Boolean(opened?.result);
      find("blank").textContent = reportInWords(all);
      const running = all.find((each) => each.state === "running") ?? all.find(isAtWork);
      find("running").hidden = !running;
      if (running) {
        const words = progressInWords(running);
        if (find("words").textContent !== words) find("words").textContent = words;
        const bar = find("bar");
        if (running.steps_total) Object.assign(bar, { max: running.steps_total, value: running.steps_done });
        else bar.removeAttribute("value");
      }
      report.update(opened);
      status.update(said);
    },
  };
}
