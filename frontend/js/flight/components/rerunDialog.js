/**
 * The form of another run: what differs from the first.
 *
 * @typedef {import("../../server/flightsApi.js").Flight} Flight
 * @typedef {Record<string, any>} Params  of the detector, by group
 *
 * @typedef {object} Beginning  what the form begins with
 * @property {Flight} flight
 * @property {Params} params  as the workbench has them
 * @property {boolean} isTuned  they are chosen
 * @property {{reason: string, text: string}[]} reasons  for which frames failed
 * @property {string} reason  empty: any
 */

import * as api from "../../server/api.js";
import { isOpen } from "../../server/flightsApi.js";
import { messageOf } from "../../server/request.js";
import { cameraGroups, cameraNote, padGroups, padNote } from "../../shared/readingLogic.js";
import { makeIntake } from "../../shared/intake.js";
import {
  fusionOf, fusionValues, onlyValues, paramsInWords, rangeFault, rangeOf, rangeValues,
} from "../../shared/orderLogic.js";
import { mountChoice } from "../../shared/components/choice.js";

/**
 * @param {HTMLDialogElement} dialog
 * @param {{onRun: (changes: Record<string, unknown>) => Promise<void>}} events  rejects where it is refused
 */
export function mountRerunDialog(dialog, { onRun }) {
  const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(`rerun-${id}`));
  const find = (/** @type {string} */ name) => /** @type {any} */ (dialog.querySelector(`[data-ref=${name}]`));
  const state = {
    pads: /** @type {api.PadSummary[]} */ ([]),
    stored: /** @type {api.CameraSummary[]} */ ([]),
    presets: /** @type {api.CameraSummary[]} */ ([]),
    pad: "",
    camera: "",
    /** @type {Record<string, Params>} */ params: {},
  };
  const padChoice = mountChoice(byId("pad"), {
    onChoose: (pad) => set({ pad }),
    onFile: (file) => void intake.takePad(file),
  });
  const cameraChoice = mountChoice(byId("camera"), {
    onChoose: (camera) => set({ camera }),
    onFile: (file) => void intake.takeCamera(file),
  });
  const intake = makeIntake({
    known: () => state,
    onPad: (pad, pads) => set({ pad, pads }),
    onCamera: (camera, cameras) => set({ camera, ...cameras }),
    onPictures: () => undefined,
    onStatus: (status) => {
      find("refusal").textContent = status?.kind === "bad" ? status.text : "";
    },
  });

  /** @param {Partial<typeof state>} change */
  function set(change) {
    Object.assign(state, change);
    const pad = state.pads.find((each) => each.id === state.pad);
    const camera = [...state.stored, ...state.presets].find((each) => each.id === state.camera);
    padChoice.update({ groups: padGroups(state.pads), chosen: state.pad, note: padNote(pad) });
    const groups = cameraGroups(state.stored, state.presets);
    cameraChoice.update({ groups, chosen: state.camera, note: cameraNote(camera) });
  }

  const range = () => ({
    first: byId("first").value,
    last: byId("last").value,
    stride: byId("stride").value,
  });

  const chosen = (/** @type {string} */ id) => byId(id).querySelector("input:checked").value;
  const choose = (/** @type {string} */ id, /** @type {string} */ value) => {
    for (const input of byId(id).querySelectorAll("input")) input.checked = input.value === value;
  };
  /** @param {string} id @param {string} value @param {boolean} isOffered */
  const offer = (id, value, isOffered) => {
    byId(id).querySelector(`input[value=${value}]`).closest("label").hidden = !isOffered;
    // One choice is none.
    byId(id).hidden = byId(id).querySelectorAll("label:not([hidden])").length < 2;
  };

  /** What the choices mean. */
  function note() {
    find("params-note").textContent = paramsInWords(state.params[chosen("params")]) || "None is changed.";
    find("reason-field").hidden = chosen("only") !== "failed";
  }

  /** @param {Event} event */
  async function submit(event) {
    event.preventDefault();
    byId("range-error").textContent = rangeFault(range());
    if (rangeFault(range()) || find("run").disabled) return;
    // A second order while the first is under way would be a second run.
    find("run").disabled = true;
    try {
      await onRun({
        // What was chosen by its id may be gone; the run keeps copies of its own.
        ...(state.pad ? { pad: state.pad } : {}),
        ...(state.camera ? { camera: state.camera } : {}),
        method: chosen("method"),
        params: state.params[chosen("params")],
        ...onlyValues(chosen("only"), byId("reason").value),
        ...fusionValues(chosen("fusion")),
        ...rangeValues(range()),
      });
      dialog.close();
    } catch (error) {
      find("refusal").textContent = messageOf(error);
    }
    find("run").disabled = false;
  }

  find("form").addEventListener("submit", submit);
  find("form").addEventListener("change", note);
  find("close").addEventListener("click", () => dialog.close());

  return {
    /** @param {Beginning} beginning */
    async open({ flight, params, isTuned, reasons, reason }) {
      const { request } = flight;
      for (const [name, value] of Object.entries(rangeOf(request))) byId(name).value = value;
      choose("method", request.method);
      choose("fusion", fusionOf(request));
      state.params = { bench: params, flight: request.params ?? {}, usual: {} };
      offer("params", "bench", isTuned);
      offer("params", "flight", Object.keys(request.params ?? {}).length > 0);
      choose("params", isTuned ? "bench" : Object.keys(request.params ?? {}).length ? "flight" : "usual");
      const hasEnded = !isOpen(flight);
      offer("only", "same", Boolean(request.only));
      offer("only", "failed", hasEnded && reasons.length > 0);
      choose("only", request.only ? "same" : "all");
      find("only-note").textContent = hasEnded ? "" : "Failed ones can be chosen when this run has ended.";
      byId("reason").replaceChildren(
        new Option("any reason", ""), ...reasons.map((each) => new Option(each.text, each.reason)),
      );
      byId("reason").value = reasons.some((each) => each.reason === reason) ? reason : "";
      byId("range-error").textContent = "";
      note();
      find("refusal").textContent = "";
      // Before it is shown: what comes in later moves the buttons from under the pointer.
      try {
        const [pads, cameras] = await Promise.all([api.listPads(), api.listCameras()]);
        const all = [...cameras.stored, ...cameras.presets];
        set({
          pads: pads.items,
          ...cameras,
          pad: pads.items.some((pad) => pad.id === request.pad_id) ? request.pad_id : "",
          camera: all.some((camera) => camera.id === request.camera_id) ? request.camera_id : "",
        });
      } catch (error) {
        find("refusal").textContent = messageOf(error);
      }
      if (!dialog.open) dialog.showModal();
    },
  };
}
