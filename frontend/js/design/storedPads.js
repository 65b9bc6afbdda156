/**
 * The pads that the server keeps: save what is shown, open, prove, import, delete.
 *
 * @typedef {import("./design.js").State} State
 * @typedef {import("./padLogic.js").PadFile} PadFile
 *
 * @typedef {object} StoredPadsOptions
 * @property {() => State} state
 * @property {(change: Partial<State>) => void} set
 * @property {() => import("./specLogic.js").PadSpec | null} specOf  the form's
 * @property {() => AbortController} begin  another pad is fetched from now on
 * @property {(file: PadFile, verification: null) => void} showPad
 * @property {(spec: import("./specLogic.js").PadSpec, signal: AbortSignal) => Promise<void>} tellBounds
 */

import * as api from "../server/api.js";
import { verifyPad } from "../server/planApi.js";
import { isAbort, messageOf } from "../server/request.js";
import { loadFault } from "../shared/components/status.js";
import { tableSizes, textsOfPad } from "./designLogic.js";
import { keptStrip } from "./printLogic.js";

/** @param {StoredPadsOptions} options */
export function makeStoredPads({ state, set, specOf, begin, showPad, tellBounds }) {
  /** @param {unknown} error */
  const fail = (error) => set({ status: { kind: "bad", text: messageOf(error) } });

  /** @param {() => Promise<void>} act */
  async function attempt(act) {
    try {
      await act();
    } catch (error) {
      fail(error);
    }
  }

  async function list() {
    try {
      set({ pads: (await api.listPads()).items });
    } catch (error) {
      set({ status: loadFault(error) });
    }
  }

  /** @returns {Promise<string | null>} the stored pad's id */
  async function save() {
    const { savedId, saving, stale, grown } = state();
    const spec = specOf();
    if (savedId) return savedId;
    if (!spec || saving) return null;
    set({ saving: true, status: { kind: "quiet", text: "Saving …" } });
    try {
      // What is shown is what is saved, also where no seed would bring it back.
      const shown = stale ? null : grown;
      const { id, name } = shown ? await api.importPad(padFile(shown.file)) : await api.createPad(spec);
      await list();
      set({ savedId: id, status: { kind: "ok", text: `Saved “${name}”.` } });
      if (state().stale) await show(id);
      return id;
    } catch (error) {
      fail(error);
      return null;
    } finally {
      set({ saving: false });
    }
  }

  /** @param {string} id */
  async function show(id) {
    const mine = begin();
    set({ busy: true });
    try {
      const { pad, ...summary } = await api.getPad(id);
      if (mine.signal.aborted) return;
      const print = { scale: summary.scale, strip: keptStrip(summary) };
      set({ savedId: id, ...print, texts: textsOfPad(summary, pad), bounds: null });
      showPad(pad, null);
    } catch (error) {
      set({ savedId: null, status: loadFault(error, () => open(id)) });
    }
    set({ busy: false });
    if (state().savedId === id) await verify(id, mine.signal);
  }

  /** @param {string} id @param {AbortSignal} signal */
  async function verify(id, signal) {
    const code = state().grown?.code;
    set({ verifying: true });
    try {
      const spec = specOf();
      if (spec) await tellBounds(spec, signal);
      const { verification } = await verifyPad(id, signal);
      // Of another size meanwhile, it is still the same code.
      const { grown, savedId } = state();
      if (grown && grown.code === code) set({ verification, grown: { ...grown, verification } });
      else if (!grown && savedId === id) set({ verification });
    } catch (error) {
      if (!isAbort(error)) fail(error);
    }
    set({ verifying: false });
  }

  /** @param {string} id */
  function open(id) {
    // At once, so that nothing is done to the pad before it.
    set({ savedId: id, viewport: null, status: null });
    void show(id);
  }

  return {
    list,
    save,
    show,
    open,
    /** @param {string} id */
    async remove(id) {
      await attempt(async () => {
        await api.deletePad(id);
        if (state().savedId === id) set({ savedId: null, scale: [1, 1], strip: null });
        set({ status: { kind: "ok", text: "Deleted the pad." } });
      });
      await list();
    },
    /** @param {File} file  to be imported */
    take: (file) =>
      attempt(async () => {
        const isPad = /\.json$/i.test(file.name);
        const { id, name } = await api.importPad(file, isPad ? {} : tableSizes(state().texts));
        await list();
        open(id);
        set({ status: { kind: "ok", text: `Imported “${name}”.` } });
      }),
  };
}

/** @param {PadFile} content @returns {File} */
const padFile = (content) => new File([JSON.stringify(content)], "pad.json", { type: "application/json" });
