/**
 * The controller of a flight's page: it alone holds the page's state.
 *
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 * @typedef {import("./timelineLogic.js").Timeline} Timeline
 * @typedef {import("./timelineLogic.js").Part} Part
 *
 * @typedef {object} State
 * @property {Flight | null} flight
 * @property {Flight[]} runs  others of the same footage
 * @property {string | null} compared  id of one of them
 * @property {Timeline | null} timeline
 * @property {Timeline | null} otherTimeline
 * @property {Timeline | null} coarse
 * @property {Timeline | null} otherCoarse
 * @property {import("./figuresLogic.js").Figures | null} figures
 * @property {import("./figuresLogic.js").Figures | null} otherFigures
 * @property {import("../server/answers.js").VehicleComparison | null} vehicle
 * @property {import("../server/flightsApi.js").Summary | null} summary
 * @property {import("./padSurfaceLogic.js").PadPicture | null} pad
 * @property {Part | null} part  of the timeline; null is the whole
 * @property {number | null} frame
 * @property {import("../shared/queueLogic.js").Frame | null} shown  the frame's result
 * @property {import("./components/framePicture.js").Picture | null} picture  of the frame; null while it comes
 * @property {import("../server/flightsApi.js").OutlineLine[]} lines  of the pad in it
 * @property {boolean} lost  the file has no picture of it
 * @property {{done: number, total: number} | null} making  how far its picture is
 * @property {string} pictureFault
 * @property {boolean} outlined  the pad is drawn over the frame
 * @property {{from: number, to: number} | null} loop  that play repeats
 * @property {number | null} rested  the frame that is on the workbench: where the user stopped last
 * @property {import("../server/tuningApi.js").Look | null} look  what the workbench made of it
 * @property {string} reason  at which "next failure" stops; empty: any
 * @property {import("./frameTableLogic.js").Filter | null} filter  of the table; null: it is closed
 * @property {import("./frameTableLogic.js").TablePage | null} tablePage
 * @property {boolean} playing
 * @property {import("../shared/components/status.js").Status} status
 */

import { addressKeeper, download, readAddress } from "../shared/address.js";
import { messageOf } from "../server/request.js";
import { makeFlightView } from "./flightView.js";
import { makeFlightData } from "./flightData.js";
import { makeFlightFrames } from "./flightFrames.js";
import * as flightsApi from "../server/flightsApi.js";
import { hasPicture, shownOf } from "./flightFrameLogic.js";
import { makeFrameLoader } from "./player/frameLoader.js";
import { makeFrameStore } from "./player/frameStore.js";
import { makePlayer } from "./player/player.js";
import { groupOf, loopFromText, loopToText, loopWith } from "./player/proxyLogic.js";
import { filterFromText, filterToText } from "./frameTableLogic.js";
import { nearestFrame, partFromText, partToText, partWith, wholeOf } from "./timelineLogic.js";
import { saveBundle } from "../shared/workbench/bundling.js";
import { copyText } from "../shared/components/copy.js";
import { mountFooter } from "../shared/components/footer.js";
import { loadFault } from "../shared/components/status.js";

const address = readAddress();
const id = location.pathname.split("/")[2];
const frameText = address.get("frame") ?? "";

/** @type {State} */
const state = {
  flight: null,
  runs: [],
  compared: address.get("with"),
  timeline: null,
  otherTimeline: null,
  coarse: null,
  otherCoarse: null,
  figures: null,
  otherFigures: null,
  vehicle: null,
  summary: null,
  pad: null,
  part: partFromText(address.get("part")),
  frame: /^\d{1,9}$/.test(frameText) ? Number(frameText) : null,
  shown: null,
  picture: null,
  lines: [],
  lost: false,
  making: null,
  pictureFault: "",
  outlined: address.get("outline") !== "off",
  loop: loopFromText(address.get("loop")),
  rested: null,
  look: null,
  reason: address.get("reason") ?? "",
  filter: filterFromText(address.get("frames")),
  tablePage: null,
  playing: false,
  status: null,
};

const view = makeFlightView(id, {
  onSeek: seek,
  onPart: (part) => {
    set({ part });
    data.timelineSoon();
  },
  onStep: (by) => step(by),
  onFailure: (by) => void findFailure(by),
  onEnd: (end) => seek(whole()?.[end] ?? 0),
  onPlay: () => play(!state.playing),
  onLoop: (end) => {
    const all = whole();
    if (all && state.frame !== null) set({ loop: end ? loopWith(state.loop, end, state.frame, all) : null });
  },
  onOutlined: (outlined) => set({ outlined }),
  onPictureAgain: () => {
    set({ pictureFault: "" });
    store.retry();
    loader.again();
  },
  onReason: (reason) => set({ reason }),
  onFilter: (filter) => frames.filter(filter),
  onTurn: (by) => frames.turn(by),
  onBench: () => keepAddress(),
  onLook: (look) => set({ look }),
  onStatus: (status) => set({ status }),
  onCompare: (compared) => {
    set({ compared: compared === state.compared ? null : compared, otherTimeline: null, otherCoarse: null, otherFigures: null });
    void data.other();
  },
  onCancel: () => void act(() => flightsApi.cancelFlight(id)),
  onRetry: () => void act(() => flightsApi.retryFlight(id)),
  onRun: async (changes) => {
    const run = await flightsApi.rerunFlight(id, changes);
    location.assign(`/flights/${run.id}?with=${id}${await frameOf(changes)}`);
  },
  onVehicle: (file) => void exportForPx4(file),
  onExport: (url) => void takeExport(url),
  onCharts: () => void data.figures(),
  onCopy: () => void copyRecord(),
  onBundle: async () => {
    if (state.frame !== null) await saveBundle(view.readingOf(state.frame), view.benchAddress(), (status) => set({ status }));
  },
});
const data = makeFlightData(id, { state: () => state, set, columns: () => view.columns() });
const frames = makeFlightFrames(id, { state: () => state, set });
const store = makeFrameStore(id, {
  onChange: (group) => {
    const all = whole();
    if (all && state.frame !== null && groupOf(state.frame, all) === group) showHeld();
  },
  onMaking: (making) => set({ making }),
  onFault: (error) => set({ pictureFault: messageOf(error), playing: false }),
});
const loader = makeFrameLoader(id, {
  onSharp: (frame, image) => {
    const { proxy } = store.get(frame);
    const [width, height] = proxy?.width ? [proxy.width, proxy.height] : [image.naturalWidth, image.naturalHeight];
    const picture = { image, scale: width / image.naturalWidth, width, height };
    set({ picture });
  },
  onRest: (frame) => set({ rested: frame, look: null }),
  onFault: (frame, error) => set({ pictureFault: `Frame ${frame}: ${messageOf(error)}` }),
});
const player = makePlayer({
  whole,
  frame: () => state.frame,
  loop: () => state.loop,
  timeOf: store.timeOf,
  isReady: (frame) => Boolean(store.get(frame).bitmap) || store.get(frame).proxy?.jpeg === null,
  onFrame: (frame) => show(frame),
  onWant: (frame) => store.want(frame),
  onEnd: () => play(false),
});

let painting = 0;
const keepAddress = addressKeeper(toAddress);
/** @type {{stop: () => void} | null} */
let watch = null;

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  painting ||= requestAnimationFrame(() => {
    painting = 0;
    view.update(state, whole());
  });
  keepAddress();
}

function whole() {
  return state.flight ? wholeOf(state.flight) : null;
}

function toAddress() {
  const { frame, part, reason, compared, filter, loop, outlined } = state;
  return {
    frame: frame === null ? null : String(frame),
    part: partToText(part),
    loop: loopToText(loop),
    outline: outlined ? null : "off",
    reason,
    with: compared,
    frames: filterToText(filter),
    sweep: view.sweepId(),
    ...view.benchAddress(),
  };
}

/** @param {number} wanted */
function seek(wanted) {
  const all = whole();
  if (!all) return;
  const frame = nearestFrame(wanted, all);
  if (frame !== state.frame) show(frame);
}

/** @param {number} frame  that the flight has */
function show(frame) {
  const all = whole();
  const part = all ? partWith(state.part, frame, all) : state.part;
  if (part !== state.part) data.timelineSoon();
  set({ frame, part, picture: null, making: null, pictureFault: "", status: null });
  store.want(frame);
  showHeld();
}

/** What is known of the frame by now. */
function showHeld() {
  const { frame, picture } = state;
  if (frame === null) return;
  const { record, lines, proxy, bitmap } = store.get(frame);
  const isSharp = picture?.image instanceof HTMLImageElement;
  const small = bitmap && proxy ? { image: bitmap, scale: proxy.scale, width: proxy.width, height: proxy.height } : null;
  const lost = proxy?.jpeg === null || (record ? !hasPicture(record) : false);
  set({ lines, lost, ...(isSharp ? {} : { picture: small }) });
  const isShown = state.shown?.answer?.result === record;
  if (record !== undefined && !isShown) set({ shown: shownOf(frame, record, state.flight) });
  loader.rest(record && !lost && !state.playing ? frame : null, sharpWidth());
}

/** Pixels that the frame's place has, in steps, so that browsers find the picture again. */
const sharpWidth = () => Math.min(4096, 320 * Math.ceil((view.pictureWidth() * devicePixelRatio) / 320) || 1280);

/** @param {number} by  frames */
function step(by) {
  const all = whole();
  if (all && state.frame !== null) seek(state.frame + by * all.stride);
}

/** @param {boolean} playing */
function play(playing) {
  set({ playing });
  player.update(playing);
  if (!playing) showHeld();
}

/** @param {1 | -1} by */
async function findFailure(by) {
  const from = state.frame ?? -1;
  const place = by > 0 ? { after: from } : { before: from };
  const wanted = state.reason ? { reason: state.reason } : { status: "failed" };
  try {
    const { items } = await flightsApi.listFrames(id, { ...wanted, ...place, limit: 1 });
    if (items.length) seek(items[0].frame);
    else set({ status: { kind: "quiet", text: `No ${by > 0 ? "later" : "earlier"} frame failed so.` } });
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

const copyRecord = () =>
  copyText(JSON.stringify(state.shown?.answer?.result, null, 1), "the record as JSON", (status) => set({ status }));

/** The first frame of a run of failed ones, for its address. @param {Record<string, any>} changes */
async function frameOf({ only }) {
  if (!only) return "";
  const { items } = await flightsApi.listFrames(id, { status: "failed", ...(only.reason ? { reason: only.reason } : {}), limit: 1 });
  return items.length ? `&frame=${items[0].frame}` : "";
}

/** @param {string} url */
async function takeExport(url) {
  try {
    await flightsApi.checkExport(url);
    download(url);
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

/** @param {File} vehicle */
async function exportForPx4(vehicle) {
  try {
    const url = URL.createObjectURL(await flightsApi.exportForPx4(id, vehicle));
    download(url, `${state.flight?.name}.px4.tlog`);
    // The browser has begun to read it by then.
    window.setTimeout(() => URL.revokeObjectURL(url), 60_000);
  } catch (error) {
    set({ status: { kind: "bad", text: `${vehicle.name}: ${messageOf(error)}` } });
  }
}

/** @param {() => Promise<Flight>} change */
async function act(change) {
  try {
    takeFlight(await change());
    follow();
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

/** @param {Flight} flight  events leave out what a flight's files hold */
function takeFlight(flight) {
  const before = state.flight;
  set({ flight: { ...before, ...flight } });
  const moved = before?.frames_done !== flight.frames_done || before?.state !== flight.state;
  if (!before || moved) {
    data.changed();
    frames.changed();
  }
  // The files were looked into since.
  if (flight.frames_total !== null && !flight.sources && !before?.sources?.length) void refresh();
  const all = whole();
  if (!all) return;
  store.follow(all, !flightsApi.isOpen(flight));
  // The address may name a frame that the flight does not have.
  const frame = nearestFrame(state.frame ?? all.first, all);
  if (!before?.sources?.length || frame !== state.frame) show(frame);
}

function follow() {
  watch?.stop();
  watch = state.flight && flightsApi.isOpen(state.flight) ? flightsApi.watchFlight(id, takeFlight) : null;
}

async function refresh() {
  takeFlight(await flightsApi.getFlight(id));
}

async function start() {
  view.restoreBench(address);
  view.update(state, null);
  try {
    await refresh();
    document.title = `${state.flight?.name} · Pad Studio`;
    follow();
    const swept = address.get("sweep");
    if (swept) void view.restoreSweep(swept);
    await data.runs();
    await data.other();
  } catch (error) {
    set({ status: loadFault(error) });
  }
}

void start();
mountFooter();
