/**
 * What orders choose from: stored pads and cameras, conditions and grounds of the simulator.
 *
 * @typedef {import("../../server/api.js").PadSummary} PadSummary
 * @typedef {import("../../server/api.js").CameraSummary} CameraSummary
 * @typedef {import("../../shared/components/status.js").Status} Status
 */

import * as api from "../../server/api.js";
import { listLooks } from "../../server/planApi.js";
import { mountChoice } from "../../shared/components/choice.js";
import { loadFault } from "../../shared/components/status.js";
import { makeIntake } from "../../shared/intake.js";
import { cameraGroups, cameraNote, padGroups, padNote } from "../../shared/readingLogic.js";

/**
 * Fill the choices of a form: `#KIND-pad`, `#KIND-camera`, and where there are any the selects of `look` and `ground`.
 * @param {HTMLFormElement} form
 * @param {{kind: string, onStatus: (status: Status) => void}} options
 */
export async function mountChoices(form, { kind, onStatus }) {
  /** @type {{pads: PadSummary[], stored: CameraSummary[], presets: CameraSummary[], pad: string, camera: string}} */
  const state = { pads: [], stored: [], presets: [], pad: "", camera: "" };
  const find = (/** @type {string} */ id) => /** @type {HTMLElement} */ (form.querySelector(`#${kind}-${id}`));
  for (const id of ["pad", "camera"]) /** @type {HTMLSelectElement} */ (find(id).querySelector("select")).required = true;
  const intake = makeIntake({
    known: () => state,
    onPad: (pad, pads) => set({ pad, pads }),
    onCamera: (camera, cameras) => set({ camera, ...cameras }),
    onPictures: () => {},
    onStatus,
  });
  const padChoice = mountChoice(find("pad"), {
    onChoose: (pad) => set({ pad }), onFile: (file) => void intake.takePad(file),
  });
  const cameraChoice = mountChoice(find("camera"), {
    onChoose: (camera) => set({ camera }), onFile: (file) => void intake.takeCamera(file),
  });

  /** @param {Partial<typeof state>} change */
  function set(change) {
    Object.assign(state, change);
    const { pads, stored, presets, pad, camera } = state;
    const chosen = [...stored, ...presets].find(({ id }) => id === camera);
    padChoice.update({ groups: padGroups(pads), chosen: pad, note: padNote(pads.find(({ id }) => id === pad)) });
    cameraChoice.update({ groups: cameraGroups(stored, presets), chosen: camera, note: cameraNote(chosen) });
  }

  try {
    const [{ items: pads }, cameras, { items: looks, grounds }] = await Promise.all([
      api.listPads(), api.listCameras(), listLooks(),
    ]);
    fill(form, "look", looks.map(({ name, note }) => [name, `${name}: ${note}`]));
    fill(form, "ground", grounds.map((ground) => [ground, ground]));
    set({ pads, ...cameras });
  } catch (error) {
    onStatus(loadFault(error));
  }
}

/** @param {HTMLFormElement} form @param {string} name @param {string[][]} options  value and text */
function fill(form, name, options) {
  const select = /** @type {HTMLSelectElement | null} */ (form.elements.namedItem(name));
  select?.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
}
