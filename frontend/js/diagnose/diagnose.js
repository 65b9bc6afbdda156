/**
 * The controller of the Diagnose page: it alone holds the page's state.
 *
 * @typedef {import("../shared/queueLogic.js").Frame} Frame
 * @typedef {import("../shared/viewportLogic.js").Viewport} Viewport
 *
 * @typedef {object} OwnState
 * @property {Frame[]} frames
 * @property {string | null} selectedId
 * @property {string | null} stage  enlarged
 * @property {string} wish  the channel that is enlarged, or "both"
 * @property {Viewport | null} viewport  of the enlarged picture
 * @property {import("../shared/components/status.js").Status} status
 *
 * @typedef {import("../shared/readingChoice.js").ReadingChoice & OwnState} State
 */

import { readAddress, writeAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { messageOf } from "../server/request.js";
import { mountChoice } from "../shared/components/choice.js";
import { mountDropZone } from "../shared/components/dropZone.js";
import { mountFrameList } from "./frameList.js";
import { mountLightbox } from "../shared/components/lightbox.js";
import { mountPoseReport } from "../shared/components/poseReport.js";
import { mountStageGrid } from "../shared/components/stageGrid.js";
import { mountStatus } from "../shared/components/status.js";
import { cameraGroups, cameraNote, missing, padGroups, padNote, resultNotes } from "../shared/readingLogic.js";
import { makeIntake } from "../shared/intake.js";
import * as queue from "../shared/queueLogic.js";
import { makeReader } from "./reader.js";
import { readingChoiceFrom } from "../shared/readingChoice.js";
import { arrangeStages, channelsOf, resultCards, stagesOf } from "../shared/stagesLogic.js";
import { viewportFromText, viewportToText } from "../shared/viewportLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const address = readAddress();
const maxBytes = Number(byId("drop-zone").dataset.maxBytes);

/** @type {State} */
const state = {
  ...readingChoiceFrom(address),
  frames: [],
  selectedId: null,
  stage: address.get("stage"),
  wish: address.get("channel") ?? "both",
  viewport: viewportFromText(address.get("at")),
  status: null,
};

const padChoice = mountChoice(byId("pad-choice"), {
  onChoose: (pad) => rerun({ pad }),
  onFile: (file) => void intake.takePad(file),
});
const cameraChoice = mountChoice(byId("camera-choice"), {
  onChoose: (camera) => rerun({ camera }),
  onFile: (file) => void intake.takeCamera(file),
});
mountDropZone(byId("drop-zone"), { onFiles: (files) => void intake.takeFiles(files) });
const frameList = mountFrameList(byId("frames"), { onSelect, onRemove });
const report = mountPoseReport(byId("report"), {
  onEnlarge: () => set({ stage: "result", viewport: null }),
  onCopy: () => void copyRecord(),
});
const grid = mountStageGrid(byId("stages"), {
  onOpen: (stage, channel) => set({ stage, wish: channel ?? state.wish, viewport: null }),
});
const lightbox = mountLightbox(byId("lightbox"), {
  onStage: (stage) => set({ stage, ...(stage ? {} : { viewport: null }) }),
  onWish: (wish) => set({ wish }),
  onViewport: (viewport) => set({ viewport }),
});
const status = mountStatus(byId("status"));

const intake = makeIntake({
  known: () => state,
  onPad: (pad, pads) => rerun({ pad, pads }),
  onCamera: (camera, cameras) => rerun({ camera, ...cameras }),
  onPictures: addPictures,
  onStatus: (status) => set({ status }),
});
const reader = makeReader({
  next: () => queue.nextWaiting(state.frames, state.selectedId),
  job: () => state,
  change,
});
let addressTimer = 0;
/** @type {import("../shared/stagesLogic.js").StageCard[]} */
const NO_CARDS = [];
/** Cards are made once an answer, so that pictures do not load anew at every change. */
const cardsOf = memoize((/** @type {queue.DetectAnswer} */ answer) => arrangeStages(stagesOf(answer)));

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  window.clearTimeout(addressTimer);
  addressTimer = window.setTimeout(writeState, 200);
}

function writeState() {
  const { pad, camera, method, stage, wish, viewport } = state;
  writeAddress({
    pad,
    camera,
    method: method === "dense" ? null : method,
    trace: selected()?.answer?.trace?.id ?? null,
    stage,
    channel: stage ? wish : null,
    at: stage ? viewportToText(viewport) : null,
  });
}

const selected = () => state.frames.find((frame) => frame.id === state.selectedId) ?? null;

function render() {
  const frame = selected();
  const camera = [...state.stored, ...state.presets].find((each) => each.id === state.camera);
  const pad = state.pads.find((each) => each.id === state.pad);
  padChoice.update({ groups: padGroups(state.pads), chosen: state.pad, note: padNote(pad) });
  const groups = cameraGroups(state.stored, state.presets);
  cameraChoice.update({ groups, chosen: state.camera, note: cameraNote(camera) });
  for (const input of byId("method").querySelectorAll("input")) {
    input.checked = input.value === state.method;
  }
  frameList.update({ frames: state.frames, selectedId: state.selectedId });
  report.update({ frame, notes: resultNotes(frame, camera) });
  const cards = frame?.answer ? cardsOf(frame.answer) : NO_CARDS;
  grid.update({ cards, channels: channelsOf(stagesOf(frame?.answer)) });
  const all = [...cards, ...resultCards(frame?.answer?.trace?.result_picture ?? null)];
  const { stage, wish, viewport } = state;
  const size = frame?.answer?.image ?? { width: 16, height: 9 };
  lightbox.update({ cards: all, stage, wish, size, viewport });
  byId("welcome").hidden = state.frames.length > 0;
  byId("missing").textContent = missing(state);
  status.update(state.status);
}

/**
 * Read every picture again under a new pad, camera or method.
 * @param {Partial<State>} change
 */
function rerun(change) {
  reader.abort();
  const frames = queue.requeued(state.frames);
  const kept = frames.some((frame) => frame.id === state.selectedId);
  set({ ...change, frames, selectedId: kept ? state.selectedId : (frames[0]?.id ?? null) });
  void reader.work();
}

/** @param {string} id @param {Partial<Frame>} values */
function change(id, values) {
  set({ frames: queue.withFrame(state.frames, id, values) });
}

/** @param {File[]} files */
function addPictures(files) {
  const added = files.map((file) => {
    const fault = queue.faultBeforeUpload(file, maxBytes);
    return queue.newFrame(file, fault);
  });
  const current = selected();
  // A picture that is being looked at stays; one that came in vain makes room.
  const kept = current && current.status !== "refused";
  const selectedId = kept ? current.id : added[0].id;
  set({ frames: [...state.frames, ...added], selectedId, stage: null });
  void reader.work();
}

/** @param {string} id */
function onSelect(id) {
  set({ selectedId: id, stage: null, viewport: null });
}

/** @param {string} id */
function onRemove(id) {
  if (state.frames.find((frame) => frame.id === id)?.status === "running") reader.abort();
  const frames = state.frames.filter((frame) => frame.id !== id);
  const selectedId = state.selectedId === id ? (frames[0]?.id ?? null) : state.selectedId;
  set({ frames, selectedId, stage: null });
}

async function copyRecord() {
  try {
    await navigator.clipboard.writeText(JSON.stringify(selected()?.answer?.result, null, 1));
    set({ status: { kind: "ok", text: "Copied the record as JSON." } });
  } catch {
    set({ status: { kind: "bad", text: "The browser does not allow copying here." } });
  }
}

/**
 * @template {object} K
 * @template V
 * @param {(key: K) => V} make
 * @returns {(key: K) => V}
 */
function memoize(make) {
  /** @type {WeakMap<K, V>} */
  const made = new WeakMap();
  return (key) => {
    if (!made.has(key)) made.set(key, make(key));
    return /** @type {V} */ (made.get(key));
  };
}

/** The result that the address names, so that a reload or a link shows it again. */
async function restore() {
  const trace = address.get("trace");
  if (!trace) return;
  try {
    const frame = queue.frameOfAnswer(await api.getDetection(trace));
    set({ frames: [frame, ...state.frames], selectedId: frame.id });
  } catch (error) {
    set({ stage: null, status: { kind: "bad", text: messageOf(error) } });
  }
}

async function start() {
  render();
  try {
    const [pads, cameras] = await Promise.all([api.listPads(), api.listCameras()]);
    const isKnown = pads.items.some((each) => each.id === state.pad);
    const pad = isKnown ? state.pad : (pads.items[0]?.id ?? "");
    set({ pads: pads.items, ...cameras, pad });
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
  await restore();
  const wanted = address.get("simulate");
  if (wanted && state.pad && state.camera) await intake.takeSimulated(wanted, state);
  void reader.work();
}

byId("try-sample").addEventListener("click", () => void intake.takeSample());
byId("method").addEventListener("change", (/** @type {Event} */ event) => {
  rerun({ method: /** @type {HTMLInputElement} */ (event.target).value });
});
void start();
