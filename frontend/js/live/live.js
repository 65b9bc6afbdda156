/**
 * The controller of the Live page: a camera over a print, read as it comes.
 *
 * @typedef {import("../server/liveApi.js").Session} Session
 * @typedef {import("./liveLogic.js").Shown} Shown
 *
 * @typedef {object} OwnState
 * @property {string} source  "camera" or "stream"
 * @property {string} device  of this device's cameras: an id, "back" or "front"
 * @property {{id: string, text: string}[]} devices
 * @property {string} size  wished for
 * @property {string} url  of the stream, as it was typed
 * @property {string[]} recent  addresses that were used before
 * @property {string} advice  why the camera cannot be used
 * @property {boolean} isBusy  starting
 * @property {Session | null} session
 * @property {string | null} returning  the session that is asked for after a reload
 * @property {Session[]} others  open on the server
 * @property {Shown[]} kept  of the last ten seconds
 * @property {number | null} place  of the one that was gone back to
 * @property {boolean} isOpening  a frame's stages
 * @property {import("../server/liveApi.js").Recording | null} recording  the last one of this page
 * @property {import("../shared/components/status.js").Status} status
 *
 * @typedef {import("../shared/readingChoice.js").ReadingChoice & OwnState} State
 */

import { addressKeeper, readAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import * as liveApi from "../server/liveApi.js";
import { ApiError, messageOf } from "../server/request.js";
import { mountChoice } from "../shared/components/choice.js";
import { mountFooter } from "../shared/components/footer.js";
import { loadFault, mountStatus } from "../shared/components/status.js";
import { makeIntake } from "../shared/intake.js";
import { readingChoiceFrom } from "../shared/readingChoice.js";
import { cameraGroups, cameraNote, padGroups, padNote } from "../shared/readingLogic.js";
import { listDevices, openCamera } from "./browserCamera.js";
import { feedCamera, feedStream } from "./feed.js";
import { mountFiguresPanel } from "./components/figuresPanel.js";
import { mountLiveView } from "./components/liveView.js";
import { mountPrintPanel } from "./components/printPanel.js";
import { mountSessionList } from "./components/sessionList.js";
import { mountSourceFields } from "./components/sourceFields.js";
import { mountStrip } from "./components/strip.js";
import {
  cameraFault, isOpen, missingInWords, recordingInWords, withoutPassword, withRecent, withShown,
} from "./liveLogic.js";
import { cameraFile, NOMINAL, nominalOf } from "./nominalCameraLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const address = readAddress();
const RECENT = "live addresses";
const SIZES = ["640x480", "1280x720", "1920x1080"];
// What a stream of unknown size is taken for; others of its aspect are read with it, too.
const STREAM_SIZE = /** @type {const} */ ([1920, 1080]);

/** @type {State} */
const state = {
  ...readingChoiceFrom(address),
  source: address.get("source") === "stream" ? "stream" : "camera",
  device: address.get("device") || "back",
  devices: [],
  size: SIZES.find((each) => each === address.get("size")) ?? "1280x720",
  url: address.get("url") ?? "",
  recent: readRecent(),
  advice: "",
  isBusy: false,
  session: null,
  returning: address.get("session"),
  others: [],
  kept: [],
  place: null,
  isOpening: false,
  recording: null,
  status: null,
};

/** @type {{stop: () => void}[]} what goes on while a session is open */
let running = [];

const padChoice = mountChoice(byId("pad-choice"), {
  onChoose: (pad) => set({ pad }),
  onFile: (file) => void intake.takePad(file),
});
const cameraChoice = mountChoice(byId("camera-choice"), {
  onChoose: (camera) => set({ camera }),
  onFile: (file) => void intake.takeCamera(file),
});
const fields = mountSourceFields(
  { source: byId("source"), camera: byId("camera-source"), stream: byId("stream-source") },
  (change) => set({ ...change, advice: "" }),
);
const view = mountLiveView(byId("view"));
const strip = mountStrip(byId("strip"), {
  onPlace: (place) => set({ place }),
  onStages: () => void openStages(),
});
const figures = mountFiguresPanel(byId("figures"));
const print = mountPrintPanel(byId("print"));
const sessions = mountSessionList(byId("sessions"), { onStop: (id) => void attempt(() => stopOther(id)) });
const status = mountStatus(byId("status"));
const intake = makeIntake({
  known: () => state,
  onPad: (pad, pads) => set({ pad, pads }),
  onCamera: (camera, cameras) => set({ camera, ...cameras }),
  onPictures: () => undefined,
  onStatus: (status) => set({ status }),
});
const keepAddress = addressKeeper(() => ({
  pad: state.pad,
  camera: state.camera,
  source: state.source === "stream" ? "stream" : null,
  url: state.source === "stream" ? withoutPassword(state.url) : null,
  device: state.source === "camera" && state.device !== "back" ? state.device : null,
  size: state.size === "1280x720" ? null : state.size,
  session: state.session && isOpen(state.session) ? state.session.id : state.returning,
}));

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  keepAddress();
}

function render() {
  const { session, kept, place, pads, stored, presets } = state;
  const isOn = isOpen(session);
  const camera = [...stored, ...presets].find((each) => each.id === state.camera);
  const nominal = nominalOf(state.camera);
  padChoice.update({ groups: padGroups(pads), chosen: state.pad, note: padNote(pads.find(({ id }) => id === state.pad)) });
  const wide = { label: "Not calibrated: about as wide as", options: NOMINAL };
  const note = nominal ? "nominal: whether the print is read is told rightly, heights only roughly" : cameraNote(camera);
  cameraChoice.update({ groups: [...cameraGroups(stored, presets), wide], chosen: state.camera, note });
  fields.update({ ...state, isBusy: state.isBusy || isOn });
  for (const id of ["pad-choice", "camera-choice"]) {
    for (const control of byId(id).querySelectorAll("select, input")) control.disabled = state.isBusy || isOn;
  }
  const shown = kept.length ? kept[place ?? kept.length - 1] : null;
  view.update({ session, shown, isPast: place !== null, isNominal: Boolean(nominal || camera?.nominal) });
  strip.update(state);
  figures.update(state);
  print.update(state);
  renderRecording();
  sessions.update(state.others.filter(({ id }) => id !== session?.id));
  const lacks = missingInWords(state);
  byId("missing").textContent = isOn || state.isBusy ? "" : lacks;
  byId("start").disabled = state.isBusy || isOn || Boolean(lacks);
  byId("start").hidden = isOn;
  byId("stop").hidden = !isOn;
  status.update(state.status);
}

function renderRecording() {
  const { session, recording } = state;
  const isOn = recording?.is_on === true;
  byId("record").hidden = !isOpen(session);
  byId("record").textContent = isOn ? "Stop recording" : "Record";
  byId("record").setAttribute("aria-pressed", String(isOn));
  const words = recordingInWords(recording);
  if (byId("recording").textContent !== words) byId("recording").textContent = words;
  byId("recorded").hidden = !recording || isOn || recording.frames === 0;
}

/** @param {() => Promise<void>} act */
async function attempt(act) {
  try {
    await act();
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

/** Start, and say what is in the way. */
async function start() {
  stopRunning();
  set({ isBusy: true, status: { kind: "quiet", text: "Starting …" }, kept: [], place: null, session: null, recording: null });
  try {
    if (state.source === "camera") await startCamera(null);
    else await startStream();
    set({ status: null });
  } catch (error) {
    stopRunning();
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
  set({ isBusy: false });
  void listOthers();
}

/** @param {Session | null} known  this page's own, from before a reload */
async function startCamera(known) {
  const camera = await ownCamera();
  if (!camera) return;
  try {
    const session = known ?? await order("browser", [camera.width, camera.height]);
    running.push({ stop: camera.close }, feedCamera(session.id, camera, feedEvents));
    camera.onEnd(() => onEnd(new Error("The camera was taken away; plug it in, then start again")));
    follow(session);
  } catch (error) {
    camera.close();
    throw error;
  }
}

/** The open camera; null where there is none, and then why stands on the page. */
async function ownCamera() {
  try {
    if (!navigator.mediaDevices) throw new TypeError("no devices");
    const camera = await openCamera(state);
    set({ advice: "", devices: await listDevices() });
    return camera;
  } catch (error) {
    const place = { isSecure: window.isSecureContext, host: location.host };
    set({ advice: cameraFault(/** @type {Error} */ (error), place), status: null });
    return null;
  }
}

async function startStream() {
  const session = await order(state.url.trim(), STREAM_SIZE);
  set({ recent: withRecent(state.recent, state.url), url: withoutPassword(state.url) });
  keepRecent();
  running.push(feedStream(session.id, feedEvents));
  follow(session);
}

/**
 * @param {string} source
 * @param {readonly [number, number]} size  of its pictures
 */
async function order(source, [width, height]) {
  const nominal = nominalOf(state.camera);
  let { camera } = state;
  if (nominal) {
    const file = new File([cameraFile(nominal, width, height)], `${nominal.id}.yaml`);
    camera = (await api.importCamera(file)).id;
  }
  return liveApi.startLive({ source, pad: state.pad, camera });
}

/** @param {Session} session */
function follow(session) {
  set({ session });
  running.push(liveApi.watchLive(session.id, {
    onSession: (told) => {
      set({ session: told, recording: told.recording ?? state.recording });
      if (!isOpen(told)) stopRunning();
    },
    onFault: (error) => onEnd(error),
  }));
}

const feedEvents = {
  onShown: (/** @type {Shown} */ shown) => {
    // What somebody looks at stays where it is.
    if (state.place === null) set({ kept: withShown(state.kept, shown), ...(state.status?.kind === "warn" ? { status: null } : {}) });
  },
  onPause: (/** @type {unknown} */ error) => set({ status: { kind: "warn", text: messageOf(error) } }),
  onEnd,
};

/** It cannot go on. @param {unknown} error */
function onEnd(error) {
  // That a session is over is told by the session itself.
  const isOver = error instanceof ApiError && error.code === "live_over";
  if (isOver) return;
  const isAway = error instanceof ApiError && error.status === 0;
  if (isAway) {
    set({ status: { kind: "warn", text: messageOf(error) } });
    return;
  }
  const isGone = error instanceof ApiError && error.status === 404;
  if (!isGone) void stop();
  else stopRunning();
  set({ session: null, status: { kind: "bad", text: isGone ? "The session is over; start it again." : messageOf(error) } });
}

function stopRunning() {
  for (const each of running) each.stop();
  running = [];
}

async function toggleRecording() {
  const { session, recording } = state;
  if (!session) return;
  const act = recording?.is_on ? liveApi.stopRecording : liveApi.record;
  set({ recording: await act(session.id) });
}

async function openFlight() {
  const { id } = await liveApi.openRecording(/** @type {NonNullable<State["recording"]>} */ (state.recording).id);
  location.assign(`/flights/${encodeURIComponent(id)}`);
}

async function stop() {
  const { session } = state;
  if (session && state.recording?.is_on) await attempt(toggleRecording);
  stopRunning();
  set({ session: null, status: null });
  if (session && isOpen(session)) await attempt(() => liveApi.stopLive(session.id));
  void listOthers();
}

/** @param {string} id */
async function stopOther(id) {
  await liveApi.stopLive(id);
  await listOthers();
}

async function listOthers() {
  try {
    const { items } = await liveApi.listLive();
    set({ others: items.filter(isOpen) });
  } catch {
    // The list is beside the point; what cannot be started says why.
  }
}

/** The frame that is shown, on the workbench with all of its stages. */
async function openStages() {
  const { kept, place, session } = state;
  const shown = kept[place ?? kept.length - 1];
  const camera = session?.camera.id ?? state.camera;
  set({ isOpening: true, place: place ?? kept.length - 1 });
  try {
    const image = new File([shown.picture], `live-${shown.frame.number}.jpg`);
    const job = { image, pads: [state.pad], camera, method: "dense", atRest: false };
    const { trace } = await api.detect(job, new AbortController().signal);
    location.assign(`/diagnose?${new URLSearchParams({ pad: state.pad, camera, trace: trace?.id ?? "" })}`);
  } catch (error) {
    set({ isOpening: false, status: { kind: "bad", text: messageOf(error) } });
  }
}

function readRecent() {
  try {
    const found = JSON.parse(localStorage.getItem(RECENT) ?? "[]");
    return Array.isArray(found) ? found.map(String) : [];
  } catch {
    return [];
  }
}

function keepRecent() {
  try {
    localStorage.setItem(RECENT, JSON.stringify(state.recent));
  } catch {
    // A browser that keeps nothing forgets addresses, too.
  }
}

/** The session that the address names, so that a reload goes on with it. */
async function restore() {
  const id = address.get("session");
  if (!id) return;
  /** @type {Session} */
  let session;
  try {
    session = await liveApi.getLive(id);
  } catch {
    return;
  }
  if (!isOpen(session)) return;
  set({ isBusy: true });
  try {
    if (session.source === "browser") await startCamera(session);
    else {
      set({ source: "stream", url: session.source });
      running.push(feedStream(session.id, feedEvents));
      follow(session);
    }
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
  set({ isBusy: false });
}

async function begin() {
  render();
  try {
    const [pads, cameras] = await Promise.all([api.listPads(), api.listCameras()]);
    const isKnown = pads.items.some(({ id }) => id === state.pad);
    const calibrated = cameras.stored.find((each) => !each.nominal);
    const camera = state.camera || calibrated?.id || NOMINAL[0].id;
    set({ pads: pads.items, ...cameras, camera, pad: isKnown ? state.pad : (pads.items[0]?.id ?? "") });
  } catch (error) {
    set({ status: loadFault(error) });
    return;
  }
  const [devices] = await Promise.all([listDevices(), listOthers()]);
  set({ devices });
  await restore();
  set({ returning: null });
}

byId("order").addEventListener("submit", (/** @type {Event} */ event) => {
  event.preventDefault();
  void start();
});
byId("stop").addEventListener("click", () => void stop());
byId("record").addEventListener("click", () => void attempt(toggleRecording));
byId("open-flight").addEventListener("click", () => void attempt(openFlight));
mountFooter();
void begin();
