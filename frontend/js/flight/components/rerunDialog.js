/**
 * The form of another run: what differs from the first.
 *
 * @typedef {import("../../server/flightsApi.js").Flight} Flight
 */

import * as api from "../../server/api.js";
import { messageOf } from "../../server/request.js";
import { cameraGroups, cameraNote, padGroups, padNote } from "../../shared/readingLogic.js";
import { makeIntake } from "../../shared/intake.js";
import { fusionOf, fusionValues, paramsFrom, rangeFault, rangeOf, rangeValues } from "../../shared/orderLogic.js";
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

  /** @param {Event} event */
  async function submit(event) {
    event.preventDefault();
    const { params, fault } = paramsFrom(byId("params").value);
    byId("params-error").textContent = fault;
    byId("range-error").textContent = rangeFault(range());
    if (fault || rangeFault(range())) return;
    const chosen = (/** @type {string} */ id) => byId(id).querySelector("input:checked").value;
    try {
      await onRun({
        // What was chosen by its id may be gone; the run keeps copies of its own.
        ...(state.pad ? { pad: state.pad } : {}),
        ...(state.camera ? { camera: state.camera } : {}),
        method: chosen("method"),
        params,
        ...fusionValues(chosen("fusion")),
        ...rangeValues(range()),
      });
      dialog.close();
    } catch (error) {
      find("refusal").textContent = messageOf(error);
    }
  }

  find("form").addEventListener("submit", submit);
  find("close").addEventListener("click", () => dialog.close());

  return {
    /** @param {Flight} flight  whose settings the form begins with */
    async open({ request }) {
      for (const [name, value] of Object.entries(rangeOf(request))) byId(name).value = value;
      for (const input of byId("method").querySelectorAll("input")) {
        input.checked = input.value === request.method;
      }
      for (const input of byId("fusion").querySelectorAll("input")) {
        input.checked = input.value === fusionOf(request);
      }
      const hasParams = Object.keys(request.params ?? {}).length > 0;
      byId("params").value = hasParams ? JSON.stringify(request.params, null, 1) : "";
      for (const name of ["params-error", "range-error"]) byId(name).textContent = "";
      find("refusal").textContent = "";
      dialog.showModal();
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
    },
  };
}
