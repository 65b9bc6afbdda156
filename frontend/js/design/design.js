/**
 * The controller of the Design page: it alone holds the page's state.
 *
 * @typedef {import("./padLogic.js").PadView} PadView
 * @typedef {import("../shared/viewportLogic.js").Viewport} Viewport
 * @typedef {import("../server/api.js").CameraSummary} CameraSummary
 *
 * @typedef {object} State
 * @property {Record<string, string>} texts  the form
 * @property {string | null} savedId  the stored pad that is shown
 * @property {[number, number]} scale  its measured size over its nominal size
 * @property {PadView | null} pad  what is shown; the last good one while a new one grows
 * @property {import("../server/planApi.js").PadBounds | null} bounds
 * @property {import("./verificationLogic.js").Verification | null} verification
 * @property {boolean} verifying
 * @property {number | null} pair  of the weakest windows, the one that is looked at
 * @property {boolean} stale  the form has changed since `pad` was grown
 * @property {string} fault  why the server grew no pad
 * @property {import("./specLogic.js").SpecErrors} refused  fields that the server refused
 * @property {boolean} busy
 * @property {boolean} saving
 * @property {string} view  "print" or a channel
 * @property {Viewport | null} viewport
 * @property {import("../server/api.js").PadSummary[]} pads
 * @property {Record<string, string>} print  the form of the print
 * @property {import("./printLogic.js").SheetPlan | null} plan
 * @property {string} planFault
 * @property {string} camera  whose heights are told
 * @property {{stored: CameraSummary[], presets: CameraSummary[]}} cameras
 * @property {import("../shared/coverageLogic.js").CoverageChart | null} chart
 * @property {import("./printLogic.js").StripReading | null} strip
 * @property {import("../shared/components/status.js").Status} status
 */

import { readAddress, writeAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { fieldFaults, isAbort, messageOf } from "../server/request.js";
import { tableSizes, textsOfPad } from "./designLogic.js";
import { makeDesignView } from "./designView.js";
import { viewOfPad } from "./padLogic.js";
import * as planApi from "../server/planApi.js";
import { makeSheetAndCoverageQueries } from "./sheetAndCoverageQueries.js";
import { fileQuery, keptStrip, parsePrint, printFromQuery, printToQuery, shapeOfPad } from "./printLogic.js";
import { makePrintActions } from "./printActions.js";
import { parseSpec, previewDelay, specFromQuery, specToQuery } from "./specLogic.js";
import { viewportFromText, viewportToText } from "../shared/viewportLogic.js";

const address = readAddress();

/** @type {State} */
const state = {
  texts: specFromQuery(address),
  savedId: address.get("pad"),
  scale: [1, 1],
  pad: null,
  bounds: null,
  verification: null,
  verifying: false,
  pair: null,
  stale: true,
  fault: "",
  refused: {},
  busy: false,
  saving: false,
  view: address.get("view") ?? "print",
  viewport: viewportFromText(address.get("at")),
  pads: [],
  print: printFromQuery(address),
  plan: null,
  planFault: "",
  camera: address.get("camera") ?? "",
  cameras: { stored: [], presets: [] },
  chart: null,
  strip: null,
  status: null,
};

const view = makeDesignView({
  onInput,
  onSave: () => void save(),
  onViewport: (viewport) => set({ viewport }),
  onView: (view) => set({ view }),
  onPair: (pair) => set({ pair, ...(pair === null ? {} : { viewport: null }) }),
  onPrint: (print) => set({ print }),
  onMeasured: (x, y) => void printActions.takeReadings(x, y),
  onStripPhoto: (photo) => void printActions.takeStripPhoto(photo),
  onStripForget: () => void printActions.forgetStrip(),
  onCamera: (camera) => set({ camera }),
  onDownload: (form) => {
    const { options } = parsePrint(state.print);
    if (options) void printActions.fetchFile(form, fileQuery(form, options));
  },
  onOpen,
  onDelete,
  onImport: (file) => void importFile(file),
});
const queries = makeSheetAndCoverageQueries({
  onPlan: (plan, planFault) => set({ plan, planFault }),
  onChart: (chart) => set({ chart }),
});

const printActions = makePrintActions({
  padId: save,
  onChange: async (change) => {
    set(change);
    await refreshList();
  },
  onStatus: (status) => set({ status }),
});

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
    ...printToQuery(state.print),
    camera: state.camera,
    view: state.view === "print" ? null : state.view,
    at: viewportToText(state.viewport),
  });
}

function render() {
  view.update(state, parseSpec(state.texts, view.bounds), parsePrint(state.print));
  const { pad, camera } = state;
  queries.want({ shape: pad && shapeOfPad(pad), options: parsePrint(state.print).options, camera });
}

/** @param {Record<string, string>} texts */
function onInput(texts) {
  set({ texts, savedId: null, scale: [1, 1], strip: null, stale: true, refused: {}, status: null });
  schedulePreview();
}

function schedulePreview() {
  const { spec } = parseSpec(state.texts, view.bounds);
  window.clearTimeout(timer);
  running?.abort();
  if (spec) timer = window.setTimeout(() => void preview(spec), previewDelay(spec));
  else set({ busy: false, pad: null, bounds: null, verification: null, fault: "" });
}

/** @param {import("./specLogic.js").PadSpec} spec */
async function preview(spec) {
  const mine = begin();
  set({ busy: true });
  try {
    await tellBounds(spec, mine.signal);
    const answer = await api.previewPad(spec, mine.signal);
    showPad(answer.pad, answer.verification);
  } catch (error) {
    if (isAbort(error)) return;
    const refused = fieldFaults(error);
    set({ pad: null, verification: null, fault: messageOf(error), refused });
  }
  set({ busy: false });
}

/** @param {import("./specLogic.js").PadSpec} spec @param {AbortSignal} signal */
async function tellBounds(spec, signal) {
  set({ bounds: await planApi.padBounds(spec, signal) });
}

/** @returns {AbortController} of the pad that is fetched from now on */
function begin() {
  window.clearTimeout(timer);
  running?.abort();
  running = new AbortController();
  return running;
}

/**
 * @param {import("./padLogic.js").PadFile} file
 * @param {import("./verificationLogic.js").Verification | null} verification
 */
function showPad(file, verification) {
  const pad = viewOfPad(file);
  const old = state.pad;
  const resized = old && (pad.widthMm !== old.widthMm || pad.heightMm !== old.heightMm);
  const seen = resized ? { viewport: null } : {};
  set({ pad, verification, pair: null, fault: "", stale: false, ...seen });
}

/** @param {unknown} error */
function fail(error) {
  set({ status: { kind: "bad", text: messageOf(error) } });
}

/** @param {() => Promise<void>} act */
async function attempt(act) {
  try {
    await act();
  } catch (error) {
    fail(error);
  }
}

/** @returns {Promise<string | null>} the stored pad's id */
async function save() {
  if (state.savedId) return state.savedId;
  const { spec } = parseSpec(state.texts, view.bounds);
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

/** @param {string} id */
async function openPad(id) {
  const mine = begin();
  set({ busy: true });
  try {
    const { pad, ...summary } = await api.getPad(id);
    if (mine.signal.aborted) return;
    const print = { scale: summary.scale, strip: keptStrip(summary) };
    set({ savedId: id, ...print, texts: textsOfPad(summary, pad), bounds: null });
    showPad(pad, null);
  } catch (error) {
    set({ savedId: null });
    fail(error);
  }
  set({ busy: false });
  if (state.savedId === id) await verify(id, mine.signal);
}

/** @param {string} id @param {AbortSignal} signal */
async function verify(id, signal) {
  set({ verifying: true });
  try {
    const { spec } = parseSpec(state.texts, view.bounds);
    if (spec) await tellBounds(spec, signal);
    const { verification } = await planApi.verifyPad(id, signal);
    if (state.savedId === id) set({ verification });
  } catch (error) {
    if (!isAbort(error)) fail(error);
  }
  set({ verifying: false });
}

/** @param {string} id */
function onOpen(id) {
  // At once, so that nothing is done to the pad before it.
  set({ savedId: id, viewport: null, status: null });
  void openPad(id);
}

/** @param {string} id */
async function onDelete(id) {
  await attempt(async () => {
    await api.deletePad(id);
    if (state.savedId === id) set({ savedId: null, scale: [1, 1], strip: null });
    set({ status: { kind: "ok", text: "Deleted the pad." } });
  });
  await refreshList();
}

/** @param {File} file */
const importFile = (file) =>
  attempt(async () => {
    const isPad = /\.json$/i.test(file.name);
    const { id, name } = await api.importPad(file, isPad ? {} : tableSizes(state.texts));
    await refreshList();
    onOpen(id);
    set({ status: { kind: "ok", text: `Imported “${name}”.` } });
  });

const refreshList = () => attempt(async () => set({ pads: (await api.listPads()).items }));

const listCameras = () => attempt(async () => set({ cameras: await api.listCameras() }));

document.addEventListener("themechange", render);
render();
void refreshList();
void listCameras();
if (state.savedId) void openPad(state.savedId);
else schedulePreview();
