/**
 * The controller of the Design page: it alone holds the page's state.
 *
 * @typedef {import("./padLogic.js").PadView} PadView
 * @typedef {import("./viewportLogic.js").Viewport} Viewport
 *
 * @typedef {object} State
 * @property {Record<string, string>} texts  the form
 * @property {string | null} savedId  the stored pad that is shown
 * @property {PadView | null} pad  what is shown; the last good one while a new one grows
 * @property {import("./verificationLogic.js").Verification | null} verification
 * @property {boolean} stale  the form has changed since `pad` was grown
 * @property {string} fault  why the server grew no pad
 * @property {import("./specLogic.js").SpecErrors} refused  fields that the server refused
 * @property {boolean} busy
 * @property {boolean} saving
 * @property {string} view  "print" or a channel
 * @property {Viewport | null} viewport
 * @property {import("./api.js").PadSummary[]} pads
 * @property {import("./components/status.js").Status} status
 */

import { download, readAddress, writeAddress } from "./address.js";
import * as api from "./api.js";
import { mountDownloads } from "./components/downloads.js";
import { mountFacts } from "./components/facts.js";
import { mountLayerStrip } from "./components/layerStrip.js";
import { mountPadList } from "./components/padList.js";
import { mountPadViewer } from "./components/padViewer.js";
import { mountSpecForm } from "./components/specForm.js";
import { mountStatus } from "./components/status.js";
import { capacityInWords, padFacts, sheetInWords, textsOfPad } from "./designLogic.js";
import { viewOfPad } from "./padLogic.js";
import { parseSpec, previewDelay, specFromQuery, specToQuery } from "./specLogic.js";
import { verificationFacts } from "./verificationLogic.js";
import { viewportFromText, viewportToText } from "./viewportLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const address = readAddress();

/** @type {State} */
const state = {
  texts: specFromQuery(address),
  savedId: address.get("pad"),
  pad: null,
  verification: null,
  stale: true,
  fault: "",
  refused: {},
  busy: false,
  saving: false,
  view: address.get("view") ?? "print",
  viewport: viewportFromText(address.get("at")),
  pads: [],
  status: null,
};

const form = mountSpecForm(byId("spec-form"), { onInput, onSave: () => void save() });
const viewer = mountPadViewer(byId("viewer"), { onViewport: (viewport) => set({ viewport }) });
const strip = mountLayerStrip(byId("layer-strip"), { onView: (view) => set({ view }) });
const facts = mountFacts(byId("pad-facts"));
const downloads = mountDownloads(byId("downloads"), { onDownload: (kind) => void fetchFile(kind) });
const padList = mountPadList(byId("pad-list"), { onOpen, onDelete });
const status = mountStatus(byId("status"));

/** @type {AbortController | null} */
let running = null;
let timer = 0;
let addressTimer = 0;

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  // Browsers limit how often the address may change; a drag changes it at every frame.
  window.clearTimeout(addressTimer);
  addressTimer = window.setTimeout(writeState, 200);
}

function writeState() {
  writeAddress({
    ...(state.savedId ? { pad: state.savedId } : specToQuery(state.texts)),
    view: state.view === "print" ? null : state.view,
    at: viewportToText(state.viewport),
  });
}

function render() {
  const { spec, errors } = parseSpec(state.texts, form.bounds);
  form.update({
    texts: state.texts,
    errors: { ...state.refused, ...errors },
    capacity: spec ? capacityInWords(spec) : "–",
    sheet: spec ? sheetInWords(spec) : "–",
    saving: state.saving,
  });
  const shown = state.pad?.layers.some((layer) => layer.channel === state.view);
  const view = shown ? state.view : "print";
  const invitation = spec ? "The pad is drawn here." : "Correct the marked fields to see the pad.";
  const message = state.fault || invitation;
  const { pad, viewport, busy } = state;
  viewer.update({ pad, view, viewport, busy, message });
  strip.update({ pad, view });
  const check = verificationFacts(state.verification);
  facts.update(pad ? [...padFacts(pad), ...check.facts] : []);
  byId("verification-fault").textContent = check.fault;
  downloads.update({ enabled: Boolean(spec ?? state.savedId) && !state.saving });
  byId("download-note").textContent = state.savedId ? "" : "A download saves the pad first.";
  padList.update({ pads: state.pads, currentId: state.savedId });
  status.update(state.status);
}

/** @param {Record<string, string>} texts */
function onInput(texts) {
  set({ texts, savedId: null, stale: true, refused: {}, status: null });
  schedulePreview();
}

function schedulePreview() {
  const { spec } = parseSpec(state.texts, form.bounds);
  window.clearTimeout(timer);
  running?.abort();
  if (spec) timer = window.setTimeout(() => void preview(spec), previewDelay(spec));
  else set({ busy: false, pad: null, fault: "" });
}

/** @param {import("./specLogic.js").PadSpec} spec */
async function preview(spec) {
  const mine = new AbortController();
  running = mine;
  set({ busy: true });
  try {
    const answer = await api.previewPad(spec, mine.signal);
    showPad(answer.pad, answer.verification);
  } catch (error) {
    if (api.isAbort(error)) return;
    set({ pad: null, fault: api.messageOf(error), refused: api.fieldFaults(error) });
  }
  set({ busy: false });
}

/**
 * @param {import("./padLogic.js").PadFile} file
 * @param {import("./verificationLogic.js").Verification | null} verification
 */
function showPad(file, verification) {
  const pad = viewOfPad(file);
  const old = state.pad;
  const resized = old && (pad.widthMm !== old.widthMm || pad.heightMm !== old.heightMm);
  set({ pad, verification, fault: "", stale: false, ...(resized ? { viewport: null } : {}) });
}

/** @param {unknown} error */
function fail(error) {
  set({ status: { kind: "bad", text: api.messageOf(error) } });
}

/** @returns {Promise<string | null>} the stored pad's id */
async function save() {
  if (state.savedId) return state.savedId;
  const { spec } = parseSpec(state.texts, form.bounds);
  if (!spec || state.saving) return null;
  set({ saving: true, status: { kind: "quiet", text: "Saving …" } });
  try {
    const { id, name } = await api.createPad(spec);
    await refreshList();
    set({ savedId: id, status: { kind: "ok", text: `Saved “${name}”.` } });
    if (state.stale) await openPad(id);
    return id;
  } catch (error) {
    fail(error);
    return null;
  } finally {
    set({ saving: false });
  }
}

/** @param {"json" | "pdf" | "svg" | "png"} kind */
async function fetchFile(kind) {
  const id = await save();
  if (id) download(api.padFileUrl(id, kind));
}

/** @param {string} id */
async function openPad(id) {
  window.clearTimeout(timer);
  running?.abort();
  set({ busy: true });
  try {
    const { pad, ...summary } = await api.getPad(id);
    set({ savedId: id, texts: textsOfPad(summary, pad) });
    showPad(pad, null);
  } catch (error) {
    set({ savedId: null });
    fail(error);
  }
  set({ busy: false });
}

/** @param {string} id */
function onOpen(id) {
  set({ viewport: null, status: null });
  void openPad(id);
}

/** @param {string} id */
async function onDelete(id) {
  try {
    await api.deletePad(id);
    if (state.savedId === id) set({ savedId: null });
    set({ status: { kind: "ok", text: "Deleted the pad." } });
  } catch (error) {
    fail(error);
  }
  await refreshList();
}

async function refreshList() {
  try {
    set({ pads: (await api.listPads()).items });
  } catch (error) {
    fail(error);
  }
}

byId("pad-import").addEventListener("change", async (/** @type {Event} */ event) => {
  const input = /** @type {HTMLInputElement} */ (event.target);
  const file = input.files?.[0];
  input.value = "";
  if (!file) return;
  try {
    const { id, name } = await api.importPad(file);
    await refreshList();
    onOpen(id);
    set({ status: { kind: "ok", text: `Imported “${name}”.` } });
  } catch (error) {
    fail(error);
  }
});

document.addEventListener("themechange", render);
render();
void refreshList();
if (state.savedId) void openPad(state.savedId);
else schedulePreview();
