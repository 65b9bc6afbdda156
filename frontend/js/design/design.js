/**
 * The controller of the Design page: it alone holds the page's state.
 *
 * @typedef {import("./padLogic.js").PadView} PadView
 * @typedef {import("../shared/viewportLogic.js").Viewport} Viewport
 * @typedef {import("../server/api.js").CameraSummary} CameraSummary
 *
 * @typedef {object} Grown
 * @property {string} code  what its code depends on, as `codeOf`
 * @property {import("./padLogic.js").PadFile} file  at the size shown
 * @property {PadView} view
 * @property {import("./verificationLogic.js").Verification | null} verification
 *
 * @typedef {object} State
 * @property {Record<string, string>} texts  the form
 * @property {string | null} savedId  the stored pad that is shown
 * @property {[number, number]} scale  its measured size over its nominal size
 * @property {PadView | null} pad  what is shown; the last good one while a new one grows
 * @property {Grown | null} grown  the pad that came from the server last, whatever is shown
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

import { addressKeeper, readAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { fieldFaults, isAbort, messageOf } from "../server/request.js";
import { makeDesignView } from "./designView.js";
import { resizedFile, resizedView, viewOfPad } from "./padLogic.js";
import * as planApi from "../server/planApi.js";
import { makeSheetAndCoverageQueries } from "./sheetAndCoverageQueries.js";
import { fileQuery, parsePrint, printFromQuery, printToQuery, shapeOfPad } from "./printLogic.js";
import { makePrintActions } from "./printActions.js";
import { makeStoredPads } from "./storedPads.js";
import { codeOf, parseSpec, previewDelay, specFromQuery, specToQuery } from "./specLogic.js";
import { viewportFromText, viewportToText } from "../shared/viewportLogic.js";
import { mountFooter } from "../shared/components/footer.js";
import { loadFault } from "../shared/components/status.js";

const address = readAddress();

/** @type {State} */
const state = {
  texts: specFromQuery(address),
  savedId: address.get("pad"),
  scale: [1, 1],
  pad: null,
  grown: null,
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
  onSave: () => void stored.save(),
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
  onOpen: (id) => stored.open(id),
  onDelete: (id) => void stored.remove(id),
  onImport: (file) => void stored.take(file),
});
const queries = makeSheetAndCoverageQueries({
  onPlan: (plan, planFault) => set({ plan, planFault }),
  onChart: (chart) => set({ chart }),
});

const stored = makeStoredPads({ state: () => state, set, specOf, begin, showPad, tellBounds });
const printActions = makePrintActions({
  padId: stored.save,
  onChange: async (change) => {
    set(change);
    await stored.list();
  },
  onStatus: (status) => set({ status }),
});

/** @type {AbortController | null} */
let running = null;
let timer = 0;
const keepAddress = addressKeeper(toAddress);

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  keepAddress();
}

function toAddress() {
  return {
    ...(state.savedId ? { pad: state.savedId } : specToQuery(state.texts)),
    ...printToQuery(state.print),
    camera: state.camera,
    view: state.view === "print" ? null : state.view,
    at: viewportToText(state.viewport),
  };
}

/** @returns {import("./specLogic.js").PadSpec | null} the form's */
function specOf() {
  return parseSpec(state.texts, view.bounds).spec;
}

function render() {
  view.update(state, parseSpec(state.texts, view.bounds), parsePrint(state.print));
  const { pad, camera } = state;
  queries.want({ shape: pad && shapeOfPad(pad), options: parsePrint(state.print).options, camera });
}

/** @param {Record<string, string>} texts */
function onInput(texts) {
  set({ texts, savedId: null, scale: [1, 1], strip: null, stale: true, refused: {}, status: null });
  if (!resize()) schedulePreview();
}

/**
 * Size, margin and name change no code: what was grown is shown at its new size.
 * @returns {boolean}  whether the form asks for no more than that
 */
function resize() {
  const spec = specOf();
  const { grown } = state;
  if (!spec || !grown || grown.code !== codeOf(spec)) return false;
  window.clearTimeout(timer);
  if (state.busy) begin();
  const file = resizedFile(grown.file, spec);
  take(file, resizedView(grown.view, file), grown.verification);
  set({ busy: false });
  return true;
}

function schedulePreview() {
  const spec = specOf();
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
 * @param {PadView} pad
 * @param {import("./verificationLogic.js").Verification | null} verification
 */
function take(file, pad, verification) {
  const old = state.pad;
  const resized = old && (pad.widthMm !== old.widthMm || pad.heightMm !== old.heightMm);
  const seen = resized ? { viewport: null } : {};
  const spec = specOf();
  const grown = spec && { code: codeOf(spec), file, view: pad, verification };
  set({ pad, grown, verification, fault: "", stale: false, ...seen });
}

/**
 * @param {import("./padLogic.js").PadFile} file
 * @param {import("./verificationLogic.js").Verification | null} verification
 */
function showPad(file, verification) {
  take(file, viewOfPad(file), verification);
  set({ pair: null });
}

async function listCameras() {
  try {
    set({ cameras: await api.listCameras() });
  } catch (error) {
    set({ status: loadFault(error) });
  }
}

document.addEventListener("themechange", render);
render();
void stored.list();
void listCameras();
if (state.savedId) void stored.show(state.savedId);
else schedulePreview();
mountFooter();
