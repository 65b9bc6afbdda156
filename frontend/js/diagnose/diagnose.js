/**
 * The controller of the Diagnose page: it alone holds the page's state.
 *
 * @typedef {import("../shared/queueLogic.js").Frame} Frame
 *
 * @typedef {object} OwnState
 * @property {Frame[]} frames
 * @property {string | null} selectedId
 * @property {boolean} atRest  the camera stood still
 * @property {import("../server/tuningApi.js").Look | null} look  the selected one on the workbench
 * @property {import("../shared/components/status.js").Status} status
 *
 * @typedef {import("../shared/readingChoice.js").ReadingChoice & OwnState} State
 */

import { addressKeeper, readAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { messageOf } from "../server/request.js";
import { openBundle as openedBundle } from "../server/bundleApi.js";
import { mountBundlePanel } from "./bundlePanel.js";
import { queryOf } from "./bundleLogic.js";
import { saveBundle } from "../shared/workbench/bundling.js";
import { mountChoice } from "../shared/components/choice.js";
import { copyText } from "../shared/components/copy.js";
import { mountDropZone } from "../shared/components/dropZone.js";
import { mountFrameList } from "./frameList.js";
import { mountMorePads } from "../shared/components/morePads.js";
import { mountPoseReport } from "../shared/components/poseReport.js";
import { mountShutterField } from "../shared/components/shutterField.js";
import { loadFault, mountStatus } from "../shared/components/status.js";
import {
  cameraGroups, cameraNote, missing, otherPads, othersNote, padGroups, padIds, padNote, resultNotes,
} from "../shared/readingLogic.js";
import { makeIntake } from "../shared/intake.js";
import * as queue from "../shared/queueLogic.js";
import { makeReader } from "./reader.js";
import { readingChoiceFrom } from "../shared/readingChoice.js";
import { turnedFile } from "./turning.js";
import { mountWorkbench } from "../shared/workbench/workbench.js";
import { mountFooter } from "../shared/components/footer.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const address = readAddress();
const maxBytes = Number(byId("drop-zone").dataset.maxBytes);

/** @type {State} */
const state = {
  ...readingChoiceFrom(address),
  frames: [],
  selectedId: null,
  atRest: address.get("rest") === "1",
  look: null,
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
const morePads = mountMorePads(byId("more-pads"), { onChoose: (others) => rerun({ others }) });
const shutter = mountShutterField(byId("shutter"), {
  onReadout: (readoutMs) => void intake.takeReadout(state.camera, readoutMs),
});
mountDropZone(byId("drop-zone"), { onFiles: (files) => void intake.takeFiles(files) });
const frameList = mountFrameList(byId("frames"), { onSelect, onRemove });
const report = mountPoseReport(byId("report"), {
  onEnlarge: () => undefined,
  onCopy: () => void copyRecord(),
  onBundle: makeBundle,
  onTurn: (quarter) => void turnBack(quarter),
  onAgain: () => {
    set({ frames: queue.triedAgain(state.frames) });
    void reader.work();
  },
});
const workbench = mountWorkbench(byId("workbench"), {
  onChange: () => keepAddress(),
  onLook: (look) => set({ look, frames: state.frames.map((each) => (each.id === state.selectedId ? queue.withReading(each, look) : each)) }),
  onStatus: (status) => set({ status }),
});
const bundlePanel = mountBundlePanel(byId("bundle"));
const status = mountStatus(byId("status"));

const intake = makeIntake({
  known: () => state,
  onPad: (pad, pads) => rerun({ pad, pads }),
  onCamera: (camera, cameras) => rerun({ camera, ...cameras }),
  onPictures: addPictures,
  onBundle: openBundle,
  onStatus: (status) => set({ status }),
});
const reader = makeReader({
  next: () => queue.nextWaiting(state.frames, state.selectedId),
  job: () => state,
  change,
});
let isRestored = false;
const keepAddress = addressKeeper(toAddress);
/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  keepAddress();
}

function toAddress() {
  const { pad, others, camera, method, atRest } = state;
  return {
    pad,
    others: others.join(","),
    camera,
    rest: atRest ? "1" : null,
    method: method === "dense" ? null : method,
    trace: isRestored ? (selected()?.answer?.trace?.id ?? null) : address.get("trace"),
    ...workbench.toAddress(),
  };
}

const selected = () => state.frames.find((frame) => frame.id === state.selectedId) ?? null;

function render() {
  const frame = selected();
  const camera = [...state.stored, ...state.presets].find((each) => each.id === state.camera);
  const pad = state.pads.find((each) => each.id === state.pad);
  padChoice.update({ groups: padGroups(state.pads), chosen: state.pad, note: padNote(pad) });
  const groups = cameraGroups(state.stored, state.presets);
  cameraChoice.update({ groups, chosen: state.camera, note: cameraNote(camera) });
  const others = padIds(state).slice(1);
  const note = othersNote(others, state.method);
  morePads.update({ options: otherPads(state.pads, state.pad), chosen: others, note });
  shutter.update({ camera });
  byId("at-rest").checked = state.atRest;
  for (const input of byId("method").querySelectorAll("input")) {
    input.checked = input.value === state.method;
  }
  frameList.update({ frames: state.frames, selectedId: state.selectedId });
  report.update({ frame: frame && tuned(frame), notes: resultNotes(frame, camera) });
  bundlePanel.update(frame?.answer?.bundle ?? null);
  const trace = frame?.answer?.trace?.id;
  workbench.update({
    subject: trace ? { trace } : null,
    name: frame?.name ?? "",
    pad: state.pad,
    others: state.others,
    camera: state.camera,
    method: state.method,
    params: state.atRest ? { refine: { at_rest: true } } : {},
    padName: pad?.name ?? "",
    cameraName: camera?.name ?? "",
  });
  byId("welcome").hidden = state.frames.length > 0;
  byId("missing").textContent = missing(state);
  status.update(state.status);
}

/**
 * A picture as it is read under the workbench's parameters.
 * @param {Frame} frame
 * @returns {Frame}
 */
function tuned(frame) {
  const { answer } = frame;
  if (!answer?.trace || !state.look || frame.status === "running") return frame;
  // The workbench shows one pad; of several pads those of the first reading are told as they are.
  if ((answer.results?.length ?? 0) > 1 && !workbench.isChanged()) return frame;
  const { result, image, stages } = state.look;
  const runs = stages.map((run) => ({ ...run, picture: null, thumbnail: null }));
  return { ...frame, answer: { ...answer, result, results: [result], image, trace: { ...answer.trace, stages: runs } } };
}

/**
 * Read every picture again under a new pad, camera or method.
 * @param {Partial<State>} change
 */
function rerun(change) {
  reader.abort();
  const frames = queue.requeued(state.frames);
  const kept = frames.some((frame) => frame.id === state.selectedId);
  set({ ...change, look: null, frames, selectedId: kept ? state.selectedId : (frames[0]?.id ?? null) });
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
  set({ frames: [...state.frames, ...added], selectedId, look: null });
  void reader.work();
}

/** @param {string} id */
function onSelect(id) {
  set({ selectedId: id, look: null });
}

/** @param {string} id */
function onRemove(id) {
  if (state.frames.find((frame) => frame.id === id)?.status === "running") reader.abort();
  const frames = state.frames.filter((frame) => frame.id !== id);
  const selectedId = state.selectedId === id ? (frames[0]?.id ?? null) : state.selectedId;
  set({ frames, selectedId, look: null });
}

/** Turn the selected picture, which was refused as turned, and read it. @param {1 | -1} quarter */
async function turnBack(quarter) {
  const frame = selected();
  if (!frame?.file || !frame.turned) return;
  try {
    const file = await turnedFile(frame.file, frame.turned, quarter);
    const fault = queue.faultBeforeUpload(file, maxBytes);
    change(frame.id, { ...queue.newFrame(file, fault), id: frame.id, turned: null });
    void reader.work();
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

async function makeBundle() {
  const reading = workbench.reading();
  const address = { ...workbench.toAddress(), rest: state.atRest ? "1" : null };
  if (reading) await saveBundle(reading, address, (status) => set({ status }));
}

/** Open a bundle at the very view where it was made. @param {File} file */
async function openBundle(file) {
  const answer = await openedBundle(file);
  const { pad, others, camera, method, params } = answer.bundle;
  const [pads, cameras] = await Promise.all([api.listPads(), api.listCameras()]);
  reader.abort();
  workbench.restore(queryOf(answer.bundle));
  const frame = queue.frameOfAnswer(answer);
  set({
    pads: pads.items, ...cameras, pad, others, camera, method, atRest: params.refine?.at_rest === true, look: null,
    // The pictures that were there are read under the bundle's terms.
    frames: [frame, ...queue.requeued(state.frames)], selectedId: frame.id,
  });
  void reader.work();
  return `Opened the bundle of ${frame.name}.`;
}

async function copyRecord() {
  const { result, results = [] } = tuned(/** @type {Frame} */ (selected())).answer ?? {};
  const copied = results.length > 1 ? results : result;
  await copyText(JSON.stringify(copied, null, 1), "the record as JSON", (status) => set({ status }));
}

/** The result that the address names, so that a reload or a link shows it again. */
async function restore() {
  const trace = address.get("trace");
  if (!trace) return;
  try {
    const frame = queue.frameOfAnswer(await api.getDetection(trace));
    set({ frames: [frame, ...state.frames], selectedId: frame.id });
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

async function start() {
  workbench.restore(address);
  render();
  void workbench.start();
  try {
    const [pads, cameras] = await Promise.all([api.listPads(), api.listCameras()]);
    const isKnown = pads.items.some((each) => each.id === state.pad);
    const pad = isKnown ? state.pad : (pads.items[0]?.id ?? "");
    set({ pads: pads.items, ...cameras, pad });
  } catch (error) {
    set({ status: loadFault(error) });
  }
  await restore();
  isRestored = true;
  const wanted = address.get("simulate");
  if (wanted && state.pad && state.camera) await intake.takeSimulated(wanted, state);
  void reader.work();
}

byId("try-sample").addEventListener("click", () => void intake.takeSample());
byId("at-rest").addEventListener("change", (/** @type {Event} */ event) => {
  rerun({ atRest: /** @type {HTMLInputElement} */ (event.target).checked });
});
byId("method").addEventListener("change", (/** @type {Event} */ event) => {
  rerun({ method: /** @type {HTMLInputElement} */ (event.target).value });
});
void start();
mountFooter();
