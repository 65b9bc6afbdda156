/**
 * The controller of a flight's page: it alone holds the page's state.
 *
 * @typedef {import("../server/flightsApi.js").Flight} Flight
 * @typedef {import("./timelineLogic.js").Timeline} Timeline
 * @typedef {import("./timelineLogic.js").Part} Part
 * @typedef {import("../shared/viewportLogic.js").Viewport} Viewport
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
 * @property {import("../server/flightsApi.js").Summary | null} summary
 * @property {[number, number] | null} padSize  mm
 * @property {Part | null} part  of the timeline; null is the whole
 * @property {number | null} frame
 * @property {import("../shared/queueLogic.js").Frame | null} shown  the frame's result
 * @property {boolean} stale  the stages shown are those of another frame
 * @property {string} reason  at which "next failure" stops; empty: any
 * @property {import("./frameTableLogic.js").Filter | null} filter  of the table; null: it is closed
 * @property {import("./frameTableLogic.js").TablePage | null} tablePage
 * @property {boolean} playing
 * @property {string | null} stage  enlarged
 * @property {string} wish  the channel that is enlarged, or "both"
 * @property {Viewport | null} viewport
 * @property {import("../shared/components/status.js").Status} status
 */

import { download, readAddress, writeAddress } from "../shared/address.js";
import { messageOf } from "../server/request.js";
import { makeFlightView } from "./flightView.js";
import { makeFlightData } from "./flightData.js";
import { makeFlightFrames } from "./flightFrames.js";
import * as flightsApi from "../server/flightsApi.js";
import { hasPicture, withPreview, withRecord, withStages } from "./flightFrameLogic.js";
import { makeFrameLoader } from "./frameLoader.js";
import { filterFromText, filterToText } from "./frameTableLogic.js";
import { nearestFrame, partFromText, partToText, partWith, wholeOf } from "./timelineLogic.js";
import { viewportFromText, viewportToText } from "../shared/viewportLogic.js";
import { watchFlight } from "../server/flightWatch.js";

const address = readAddress();
const id = location.pathname.split("/")[2];
const PLAY_MS = 100;
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
  summary: null,
  padSize: null,
  part: partFromText(address.get("part")),
  frame: /^\d{1,9}$/.test(frameText) ? Number(frameText) : null,
  shown: null,
  stale: false,
  reason: address.get("reason") ?? "",
  filter: filterFromText(address.get("frames")),
  tablePage: null,
  playing: false,
  stage: address.get("stage"),
  wish: address.get("channel") ?? "both",
  viewport: viewportFromText(address.get("at")),
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
  onPlay: () => {
    set({ playing: !state.playing });
    play();
  },
  onReason: (reason) => set({ reason }),
  onFilter: (filter) => frames.filter(filter),
  onTurn: (by) => frames.turn(by),
  onStage: (stage, wish) => set({ stage, ...(wish ? { wish } : {}), viewport: null }),
  onLightbox: (change) => set(change),
  onCompare: (compared) => {
    set({ compared: compared === state.compared ? null : compared, otherTimeline: null, otherCoarse: null, otherFigures: null });
    void data.other();
  },
  onCancel: () => void act(() => flightsApi.cancelFlight(id)),
  onRetry: () => void act(() => flightsApi.retryFlight(id)),
  onRun: async (changes) => {
    const run = await flightsApi.rerunFlight(id, changes);
    location.assign(`/flights/${run.id}?with=${id}`);
  },
  onVehicle: (file) => void exportForPx4(file),
  onCharts: () => void data.figures(),
  onCopy: () => void copyRecord(),
});
const data = makeFlightData(id, { state: () => state, set, columns: () => view.columns() });
const frames = makeFlightFrames(id, { state: () => state, set });
const loader = makeFrameLoader(id, {
  onRecord: (frame, record) => {
    set(withRecord(state, frame, record));
    if (record && !hasPicture(record)) playOn();
  },
  onPreview: (_, url, size) => {
    set(withPreview(state, url, size));
    playOn();
  },
  onStages: (frame, stages, size) => set(withStages(state, frame, stages, size)),
  onFault: (frame, error) => {
    set({ stale: false, playing: false, status: { kind: "bad", text: `Frame ${frame}: ${messageOf(error)}` } });
  },
});

let painting = 0;
let addressTimer = 0;
/** @type {{stop: () => void} | null} */
let watch = null;

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  painting ||= requestAnimationFrame(() => {
    painting = 0;
    view.update(state, whole());
  });
  window.clearTimeout(addressTimer);
  addressTimer = window.setTimeout(writeState, 200);
}

const whole = () => (state.flight ? wholeOf(state.flight) : null);

function writeState() {
  const { frame, stage, wish, viewport, part, reason, compared, filter } = state;
  writeAddress({
    frame: frame === null ? null : String(frame),
    part: partToText(part),
    reason,
    with: compared,
    frames: filterToText(filter),
    stage,
    channel: stage ? wish : null,
    at: stage ? viewportToText(viewport) : null,
  });
}

/** @param {number} wanted */
function seek(wanted) {
  const all = whole();
  if (!all) return;
  const frame = nearestFrame(wanted, all);
  const part = partWith(state.part, frame, all);
  if (part !== state.part) data.timelineSoon();
  if (frame !== state.frame) set({ frame, part, stale: true, status: null });
  loader.want(frame);
}

/** @param {1 | -1} by */
function step(by) {
  const all = whole();
  if (all && state.frame !== null) seek(state.frame + by * all.stride);
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

function playOn() {
  if (state.playing) window.setTimeout(play, PLAY_MS);
}

/** One frame on, as soon as the one before is shown; the next ones' pictures come meanwhile. */
function play() {
  const all = whole();
  if (!state.playing || !all || state.frame === null) return;
  if (state.frame >= all.last) {
    set({ playing: false });
    return;
  }
  step(1);
  for (const ahead of [1, 2]) {
    const frame = state.frame + ahead * all.stride;
    if (frame <= all.last) loader.prepare(frame);
  }
}

async function copyRecord() {
  try {
    await navigator.clipboard.writeText(JSON.stringify(state.shown?.answer?.result, null, 1));
    set({ status: { kind: "ok", text: "Copied the record as JSON." } });
  } catch {
    set({ status: { kind: "bad", text: "The browser does not allow copying here." } });
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
  if (state.shown?.answer) return;
  const isFirst = state.frame === null;
  // The address may name a frame that the flight does not have.
  seek(state.frame ?? whole()?.first ?? 0);
  if (!isFirst) loader.again();
}

function follow() {
  watch?.stop();
  watch = state.flight && flightsApi.isOpen(state.flight) ? watchFlight(id, takeFlight) : null;
}

async function refresh() {
  takeFlight(await flightsApi.getFlight(id));
}

async function start() {
  view.update(state, null);
  try {
    await refresh();
    document.title = `${state.flight?.name} · Pad Studio`;
    follow();
    await data.runs();
    await data.other();
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

void start();
