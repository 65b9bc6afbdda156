/**
 * The controller of the Flights page: the list, and the order of a new one.
 *
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 *
 * @typedef {object} OwnState
 * @property {import("./uploadsLogic.js").Item[]} items  files of the new flight
 * @property {boolean} ordered  starts as soon as all files are there
 * @property {boolean} starting  it is ordered, and the server has not answered yet
 * @property {Flight[]} flights
 * @property {number | null} total  of them; null until it is known
 * @property {number} limit  of those that are shown
 * @property {import("../shared/components/status.js").Status} status
 *
 * @typedef {import("../shared/readingChoice.js").ReadingChoice & OwnState} State
 */

import { readAddress, writeAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { ApiError, messageOf } from "../server/request.js";
import { mountChoice } from "../shared/components/choice.js";
import { mountDropZone } from "../shared/components/dropZone.js";
import { mountFlightList } from "./flightList.js";
import { mountMorePads } from "../shared/components/morePads.js";
import { mountShutterField } from "../shared/components/shutterField.js";
import { loadFault, mountStatus } from "../shared/components/status.js";
import { mountUploadList } from "./uploadList.js";
import {
  cameraGroups, cameraNote, otherPads, othersNote, padGroups, padIds, padNote,
} from "../shared/readingLogic.js";
import * as flightsApi from "../server/flightsApi.js";
import { makeIntake } from "../shared/intake.js";
import { fusionValues, missingOrder, rangeFault, rangeValues } from "../shared/orderLogic.js";
import { readingChoiceFrom } from "../shared/readingChoice.js";
import { makeUploadQueue } from "./uploadQueue.js";
import { fewPictures, hasTopics, isLive, mayBringCamera, readyIds, totals } from "./uploadsLogic.js";
import { mountFooter } from "../shared/components/footer.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const address = readAddress();
const PAGE = 50;
const BUSY_MS = 1000;
const IDLE_MS = 10_000;
const USUAL_FUSION = "filter";

/** @type {State} */
const state = {
  ...readingChoiceFrom(address),
  items: [],
  ordered: false,
  starting: false,
  flights: [],
  total: null,
  limit: PAGE,
  status: null,
};
/** @type {WeakMap<File, string>} */
const folders = new WeakMap();

const padChoice = mountChoice(byId("pad-choice"), {
  onChoose: (pad) => set({ pad }),
  onFile: (file) => void intake.takePad(file),
});
const cameraChoice = mountChoice(byId("camera-choice"), {
  onChoose: (camera) => set({ camera }),
  onFile: (file) => void intake.takeCamera(file),
});
const morePads = mountMorePads(byId("more-pads"), { onChoose: (others) => set({ others }) });
const shutter = mountShutterField(byId("shutter"), {
  onReadout: (readoutMs) => void intake.takeReadout(state.camera, readoutMs),
});
const uploadList = mountUploadList(byId("uploads"), { onRemove: (keys) => queue.remove(keys) });
const flightList = mountFlightList(byId("flights"), {
  onCancel: (id) => void act(() => flightsApi.cancelFlight(id)),
  onRemove: (flight) => {
    if (window.confirm(`Remove the flight “${flight.name}” and its results?`)) {
      void act(() => flightsApi.deleteFlight(flight.id));
    }
  },
  onMore: () => {
    set({ limit: state.limit + PAGE });
    void refresh();
  },
});
const status = mountStatus(byId("status"));
const intake = makeIntake({
  known: () => state,
  onPad: (pad, pads) => set({ pad, pads }),
  onCamera: (camera, cameras) => set({ camera, ...cameras }),
  onPictures: (files) => queue.add(files.map((file) => ({ file, folder: folders.get(file) ?? "" }))),
  onStatus: (status) => set({ status }),
});
const queue = makeUploadQueue({ onChange: (items) => set({ items }) });
mountDropZone(byId("drop-zone"), {
  onFiles: (files, chosen) => {
    for (const { file, folder } of chosen) folders.set(file, folder);
    void intake.takeFiles(files);
  },
});

let frame = 0;
let refreshTimer = 0;

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  // Thousands of small files report often; the page is drawn once a frame.
  frame ||= requestAnimationFrame(() => {
    frame = 0;
    render();
  });
}

function render() {
  const { pads, stored, presets, items, ordered, method } = state;
  const pad = pads.find((each) => each.id === state.pad);
  const camera = [...stored, ...presets].find((each) => each.id === state.camera);
  padChoice.update({ groups: padGroups(pads), chosen: state.pad, note: padNote(pad) });
  const groups = cameraGroups(stored, presets);
  cameraChoice.update({ groups, chosen: state.camera, note: cameraNote(camera) });
  const others = padIds(state).slice(1);
  morePads.update({ options: otherPads(pads, state.pad), chosen: others, note: othersNote(others, method) });
  shutter.update({ camera });
  for (const input of byId("method").querySelectorAll("input")) input.checked = input.value === method;
  uploadList.update({ items });
  byId("few-pictures").hidden = !fewPictures(items);
  const live = isLive(items);
  byId("live-recording").hidden = !live;
  flightList.update({ flights: state.flights, total: state.total, now: Date.now() });
  byId("topic-field").hidden = live || !hasTopics(items);
  const comes = takesRecordedCamera() ? "recorded" : "";
  const needed = live ? "" : missingOrder({ pad: state.pad, camera: state.camera || comes, files: totals(items).total });
  const hint = ordered ? "Starts as soon as every file is sent." : needed;
  if (byId("missing").textContent !== hint) byId("missing").textContent = hint;
  const act = live ? "Open" : "Analyse";
  byId("start").textContent = ordered ? "Do not start" : readyIds(items) ? act : `${act} when sent`;
  // A second order while the first is under way would be a second flight.
  byId("start").disabled = Boolean(needed) || state.starting;
  status.update(state.status);
  writeAddress({
    pad: state.pad,
    others: state.others.join(","),
    camera: state.camera,
    method: method === "dense" ? null : method,
    fusion: fusionField().value === USUAL_FUSION ? null : fusionField().value,
    ...rangeFields(),
    name: byId("flight-name").value,
    topic: byId("topic").value,
  });
  if (ordered && readyIds(items)) void start();
}

/** True where the order names no camera, as the recordings bring it. */
const takesRecordedCamera = () => mayBringCamera(state.items) && (byId("recorded-camera").checked || !state.camera);

const fusionField = () => byId("fusion").querySelector("input:checked");

/** What was typed before a reload. */
function restoreFields() {
  for (const name of Object.keys(rangeFields())) byId(name).value = address.get(name) ?? "";
  byId("flight-name").value = address.get("name") ?? "";
  byId("topic").value = address.get("topic") ?? "";
  for (const input of byId("fusion").querySelectorAll("input")) {
    if (input.value === address.get("fusion")) input.checked = true;
  }
  checkRange();
}

const rangeFields = () => ({
  first: byId("first").value,
  last: byId("last").value,
  stride: byId("stride").value,
});

async function start() {
  set({ ordered: false, starting: true, status: { kind: "quiet", text: "Starting …" } });
  const { method } = state;
  const camera = takesRecordedCamera() ? "" : state.camera;
  const pads = padIds(state);
  const pad = pads.length > 1 ? pads : state.pad;
  const name = byId("flight-name").value.trim();
  const uploads = readyIds(state.items) ?? [];
  const fusion = fusionValues(fusionField().value);
  const read = { method, ...fusion, ...rangeValues(rangeFields()) };
  const topic = hasTopics(state.items) ? byId("topic").value.trim() : "";
  const order = {
    uploads, pad, ...read, ...(camera ? { camera } : {}), ...(name ? { name } : {}), ...(topic ? { topic } : {}),
  };
  try {
    const flight = isLive(state.items)
      ? await flightsApi.openRecording({ uploads, ...(name ? { name } : {}) })
      : await flightsApi.createFlight(order);
    queue.clear();
    location.assign(`/flights/${flight.id}`);
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
    if (error instanceof ApiError && Array.isArray(error.detail.topics)) offerTopics(error.detail.topics);
  }
  set({ starting: false });
}

/** @param {string[]} topics  of which one is to be chosen */
function offerTopics(topics) {
  byId("topics").replaceChildren(...topics.map((each) => new Option(each, each)));
  byId("topic-field").hidden = false;
  byId("topic").focus();
}

function checkRange() {
  const fault = rangeFault(rangeFields());
  byId("range-error").textContent = fault;
  for (const input of byId("range").querySelectorAll("input")) input.ariaInvalid = String(Boolean(fault));
  return !fault;
}

/** @param {() => Promise<unknown>} change  of a flight in the list */
async function act(change) {
  try {
    await change();
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
  await refresh();
}

async function refresh() {
  window.clearTimeout(refreshTimer);
  try {
    const { items, total } = await flightsApi.listFlights(Math.min(state.limit, 200));
    set({ flights: items, total });
  } catch (error) {
    if (state.total === null) set({ status: loadFault(error) });
  }
  const wait = state.flights.some(flightsApi.isOpen) ? BUSY_MS : IDLE_MS;
  refreshTimer = window.setTimeout(() => (document.hidden ? null : void refresh()), wait);
}

async function load() {
  restoreFields();
  render();
  void refresh();
  void queue.restore();
  try {
    const [pads, cameras] = await Promise.all([api.listPads(), api.listCameras()]);
    const isKnown = pads.items.some((each) => each.id === state.pad);
    const pad = isKnown ? state.pad : (pads.items[0]?.id ?? "");
    const only = cameras.stored.length === 1 ? cameras.stored[0].id : "";
    set({ pads: pads.items, ...cameras, pad, camera: state.camera || only });
  } catch (error) {
    set({ status: loadFault(error) });
  }
}

byId("method").addEventListener("change", (/** @type {Event} */ event) => {
  set({ method: /** @type {HTMLInputElement} */ (event.target).value });
});
byId("range").addEventListener("input", checkRange);
byId("order").addEventListener("input", () => set({}));
byId("order").addEventListener("submit", (/** @type {Event} */ event) => {
  event.preventDefault();
  if (state.starting) return;
  if (checkRange()) set({ ordered: !state.ordered, status: null });
  else byId("first").focus();
});
document.addEventListener("visibilitychange", () => (document.hidden ? null : void refresh()));
window.addEventListener("beforeunload", (event) => {
  if (state.items.some((item) => item.status === "sending")) event.preventDefault();
});
void load();
mountFooter();
