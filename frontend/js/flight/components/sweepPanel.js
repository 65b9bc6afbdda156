/**
 * Reads failing frames, and some that have a pose, under several values of one parameter.
 *
 * @typedef {import("../../server/tuningApi.js").Parameter} Parameter
 * @typedef {import("../../server/tuningApi.js").Sweep} Sweep
 */

import { ApiError, messageOf } from "../../server/request.js";
import { getSweep, listParameters, startSweep, stopSweep } from "../../server/tuningApi.js";
import { makeDraft } from "../../shared/address.js";
import { mountPlot } from "../../shared/components/plot.js";
import { rangeFault, sweepChart, sweepInWords, usualRange, valueInWords, valuesBetween } from "../sweepLogic.js";

const AGAIN_MS = 400;
/** Until a server that did not answer is asked again. */
const LATER_MS = 2000;

/**
 * @param {HTMLDetailsElement} root
 * @param {string} id  of the flight
 * @param {object} page
 * @param {() => {method: string, params: Record<string, any>}} page.settings  of the other parameters
 * @param {(name: string, value: number | boolean) => void} page.onTake
 * @param {() => void} page.onBegin  there is another sweep to come back to
 */
export function mountSweepPanel(root, id, { settings, onTake, onBegin }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const plot = mountPlot(find("chart"), { onFrame: (at) => take(at) });
  /** @type {Parameter[]} */
  let all = [];
  /** @type {Sweep | null} */
  let sweep = null;
  let timer = 0;

  const chosen = () => all.find(({ name }) => name === find("parameter").value);
  const range = () => ({ from: find("from").valueAsNumber, to: find("to").valueAsNumber, count: find("count").valueAsNumber });

  const fields = () => ["parameter", "from", "to", "count", "failed", "read"].map(find);
  const draft = makeDraft("sweep", fields);

  async function load() {
    if (all.length) return;
    try {
      const { method } = settings();
      all = (await listParameters()).filter(({ methods, followed }) => methods.includes(method) && !followed);
      find("parameter").replaceChildren(...all.map(({ name }) => new Option(name, name)));
      offer();
      restoreDraft();
    } catch (error) {
      find("fault").textContent = messageOf(error);
    }
  }

  function restoreDraft() {
    const typed = draft.read();
    if (!typed || !all.some(({ name }) => name === typed[0])) return;
    find("parameter").value = typed[0];
    offer();
    fields().forEach((field, at) => { field.value = typed[at]; });
  }

  /** The usual range of the parameter that is chosen. */
  function offer() {
    const parameter = chosen();
    if (!parameter) return;
    const { from, to } = usualRange(parameter);
    [find("from").value, find("to").value] = [from, to];
    find("range").hidden = parameter.kind === "bool";
    find("about").textContent = [parameter.text.replaceAll("`", ""), parameter.unit && `In ${parameter.unit}.`].filter(Boolean).join(" ");
    find("fault").textContent = "";
  }

  /** @param {Event} event */
  async function begin(event) {
    event.preventDefault();
    const parameter = chosen();
    if (!parameter) return;
    find("fault").textContent = rangeFault(parameter, range());
    if (find("fault").textContent) return;
    if (find("begin").disabled) return;
    // A second one while the first is asked for would be one that nobody sees.
    find("begin").disabled = true;
    window.clearTimeout(timer);
    try {
      const frames = { failed: find("failed").valueAsNumber, read: find("read").valueAsNumber };
      sweep = await startSweep(id, { parameter: parameter.name, values: valuesBetween(parameter, range()), ...frames, ...settings() });
      onBegin();
    } catch (error) {
      find("fault").textContent = messageOf(error);
    }
    find("begin").disabled = false;
    follow();
  }

  /** Show it, and look again while it runs. */
  function follow() {
    render();
    if (isRunning()) timer = window.setTimeout(() => void look(), AGAIN_MS);
  }

  async function look() {
    const asked = /** @type {Sweep} */ (sweep);
    try {
      sweep = await getSweep(asked.id);
      find("fault").textContent = "";
      follow();
    } catch (error) {
      find("fault").textContent = messageOf(error);
      if (!(error instanceof ApiError && error.status === 404)) {
        timer = window.setTimeout(() => void look(), LATER_MS);
        return;
      }
      // It went with the server that made it.
      sweep = null;
      render();
    }
  }

  async function stop() {
    if (!sweep) return;
    try {
      await stopSweep(sweep.id);
    } catch (error) {
      find("fault").textContent = messageOf(error);
    }
  }

  const isRunning = () => sweep?.state === "queued" || sweep?.state === "running";

  /** @param {number} at */
  function take(at) {
    if (sweep) onTake(sweep.parameter, sweep.values[at]);
  }

  function render() {
    const shown = sweep;
    find("result").hidden = !shown;
    find("bar").hidden = find("stop").hidden = !isRunning();
    find("begin").disabled = isRunning();
    if (!shown) return;
    find("words").textContent = sweepInWords(shown);
    [find("bar").max, find("bar").value] = [shown.frames_total, shown.frames_done];
    const { unit = "" } = all.find(({ name }) => name === shown.parameter) ?? {};
    plot.show((colour) => sweepChart(shown, unit, colour));
    find("rows").replaceChildren(...shown.values.map((value, at) => {
      const row = find("row").content.firstElementChild.cloneNode(true);
      const part = (/** @type {string} */ name) => row.querySelector(`[data-ref=${name}]`);
      [part("value").textContent, part("won").textContent, part("lost").textContent] = [valueInWords(value, unit), shown.won[at], shown.lost[at]].map(String);
      part("take").setAttribute("aria-label", `Take ${value}`);
      part("take").addEventListener("click", () => take(at));
      return row;
    }));
  }

  root.addEventListener("toggle", () => {
    if (root.open) void load();
  });
  find("parameter").addEventListener("change", offer);
  find("form").addEventListener("submit", begin);
  find("stop").addEventListener("click", () => void stop());

  return {
    /** The sweep that is shown; null where there is none. */
    sweepId: () => sweep?.id ?? null,
    /** Show a sweep again, as long as the server knows it. @param {string} sweepId */
    async restore(sweepId) {
      const found = await getSweep(sweepId).catch(() => null);
      if (found?.flight !== id) return;
      await load();
      sweep = found;
      find("parameter").value = found.parameter;
      offer();
      const { values } = found;
      if (typeof values[0] === "number") [find("from").value, find("to").value, find("count").value] = [values[0], values.at(-1), values.length];
      root.open = true;
      onBegin();
      follow();
    },
  };
}
