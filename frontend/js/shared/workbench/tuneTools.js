/**
 * What is done with the values as a whole: reset, presets, copied as a link or as a command line.
 *
 * @typedef {import("./paramsLogic.js").Values} Values
 * @typedef {import("../../server/tuningApi.js").Parameter} Parameter
 */

import { copyText } from "../components/copy.js";
import { makeDraft } from "../address.js";
import { messageOf } from "../../server/request.js";
import { deletePreset, listPresets, savePreset } from "../../server/tuningApi.js";
import { commandLine, flat, nested, replaceQuestion } from "./paramsLogic.js";

/**
 * @param {HTMLElement} root
 * @param {object} events
 * @param {(values: Values) => void} events.onValues
 * @param {(status: import("../components/status.js").Status) => void} events.onStatus
 * @param {() => void} [events.onRunAgain]  nothing where a page has no flight
 */
export function mountTuneTools(root, { onValues, onStatus, onRunAgain }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  /** @type {{frame: import("./workbench.js").Frame | null, values: Values, all: Parameter[]}} */
  let state = { frame: null, values: {}, all: [] };
  /** @type {import("../../server/tuningApi.js").Preset[]} */
  let presets = [];

  /** @param {() => Promise<unknown>} act @param {string} done */
  async function change(act, done) {
    try {
      await act();
      presets = await listPresets();
      show();
      if (done) onStatus({ kind: "ok", text: done });
    } catch (error) {
      onStatus({ kind: "bad", text: messageOf(error) });
    }
  }

  function show() {
    const mine = presets.filter(({ method }) => method === state.frame?.method);
    const options = mine.map(({ name }) => new Option(name, name));
    find("preset").replaceChildren(new Option(mine.length ? "Choose …" : "None yet", ""), ...options);
    find("preset").disabled = !mine.length;
    find("preset-delete").disabled = true;
  }

  find("reset-all").addEventListener("click", () => onValues({}));
  find("run-again").hidden = !onRunAgain;
  find("run-again").addEventListener("click", () => onRunAgain?.());
  find("copy-link").addEventListener("click", () => void copyText(location.href, "the link", onStatus));
  find("copy-command").addEventListener("click", () => {
    const { frame, values } = state;
    if (!frame) return;
    const reading = { pad: `${frame.padName || "pad"}.json`, camera: frame.cameraName || "camera.yaml", method: frame.method, source: frame.name, values };
    void copyText(commandLine(reading), "the command line", onStatus);
  });
  find("preset").addEventListener("change", () => {
    const preset = presets.find(({ name, method }) => name === find("preset").value && method === state.frame?.method);
    find("preset-delete").disabled = !preset;
    if (preset) onValues(flat(preset.params, state.all));
  });
  find("preset-delete").addEventListener("click", () => {
    const name = find("preset").value;
    if (!name || !window.confirm(`Remove the preset “${name}”, for everybody who uses this server?`)) return;
    void change(() => deletePreset(name), `Removed the preset ${name}.`);
  });
  find("preset-form").addEventListener("submit", (/** @type {Event} */ event) => {
    event.preventDefault();
    const name = find("preset-name").value.trim();
    const { frame, values } = state;
    if (!name || !frame) return;
    void keep({ name, method: frame.method, params: nested(values) });
  });

  /** @param {{name: string, method: string, params: Record<string, any>}} preset */
  async function keep(preset) {
    await change(async () => undefined, "");
    // Others may have kept it, in another tab or for another method.
    const question = replaceQuestion(preset, presets);
    if (question && !window.confirm(question)) return;
    await change(async () => {
      await savePreset(preset);
      find("preset-name").value = "";
      draft.forget();
    }, `Kept as ${preset.name}, for everybody who uses this server.`);
  }
  let method = "";
  const draft = makeDraft("preset", () => [find("preset-name")]);
  find("preset-name").value = draft.read()?.[0] ?? "";

  return {
    /** @param {{frame: import("./workbench.js").Frame, values: Values, all: Parameter[]}} next */
    update(next) {
      state = next;
      const count = Object.keys(next.values).length;
      find("changed-count").textContent = count ? `${count} changed` : "all as usual";
      find("reset-all").disabled = !count;
      find("preset-save").disabled = !count;
      if (method !== next.frame.method) {
        method = next.frame.method;
        void change(async () => undefined, "");
      }
    },
  };
}
