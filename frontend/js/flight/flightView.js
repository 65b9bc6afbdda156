/**
 * All components of a flight's page, brought up to date together.
 *
 * @typedef {import("./flight.js").State} State
 */

import { mountCharts } from "./components/charts.js";
import { mountComparePanel } from "./components/comparePanel.js";
import { mountExportList } from "./components/exportList.js";
import { mountFacts } from "../shared/components/facts.js";
import { mountFrameTable } from "./components/frameTable.js";
import { mountFlightHead } from "./components/flightHead.js";
import { mountFramePicture } from "./components/framePicture.js";
import { mountPoseReport } from "../shared/components/poseReport.js";
import { mountRerunDialog } from "./components/rerunDialog.js";
import { mountRunList } from "./components/runList.js";
import { mountSweepPanel } from "./components/sweepPanel.js";
import { mountStatus } from "../shared/components/status.js";
import { mountTimeline } from "./components/timeline.js";
import { mountTransport } from "./components/transport.js";
import { reasonsOf, settingsFacts, summaryFacts } from "./flightLogic.js";
import { mountWorkbench } from "../shared/workbench/workbench.js";
import { withLook } from "./flightFrameLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));

/**
 * @param {string} id  of the flight
 * @param {Record<string, (...values: any[]) => any>} on  events, as flight.js answers them
 */
export function makeFlightView(id, on) {
  /** @type {State["flight"]} */
  let flight = null;
  /** @type {{reason: string, text: string}[]} */
  let reasons = [];
  let reason = "";
  const head = mountFlightHead(byId("head"), {
    onCancel: on.onCancel,
    onRetry: on.onRetry,
    onRerun: openRerun,
  });
  const timeline = mountTimeline(byId("timeline"), { onSeek: on.onSeek, onPart: on.onPart });
  const transport = mountTransport(byId("transport"), {
    onStep: on.onStep,
    onFailure: on.onFailure,
    onFrame: on.onSeek,
    onPlay: on.onPlay,
    onLoop: on.onLoop,
    onReason: on.onReason,
    onWhole: () => on.onPart(null),
    onEnd: on.onEnd,
  });
  const table = mountFrameTable(byId("frames"), { onFilter: on.onFilter, onTurn: on.onTurn, onSeek: on.onSeek });
  const picture = mountFramePicture(byId("frame"), {
    onEnlarge: () => bench.open({ stage: "pose", channel: null }),
    onOutlined: on.onOutlined,
    onAgain: on.onPictureAgain,
  });
  const report = mountPoseReport(byId("report"), { onEnlarge: () => undefined, onCopy: on.onCopy, onBundle: on.onBundle });
  const bench = mountWorkbench(byId("workbench"), { onChange: on.onBench, onLook: on.onLook, onStatus: on.onStatus, onRunAgain: openRerun });
  const sweep = mountSweepPanel(byId("sweep"), id, {
    settings: () => ({ method: flight?.request.method ?? "dense", params: bench.params() }),
    onTake: (name, value) => bench.take(name, value),
    onBegin: on.onBench,
  });
  const compare = mountComparePanel(byId("compared"), id, { onSeek: on.onSeek });
  const summary = mountFacts(byId("summary"));
  const settings = mountFacts(byId("settings"));
  const exports = mountExportList(byId("downloads"), id, { onVehicle: on.onVehicle, onExport: on.onExport });
  const runs = mountRunList(byId("runs"), { onCompare: on.onCompare });
  const charts = mountCharts(byId("charts"), { onSeek: on.onSeek, onVisible: on.onCharts });
  const rerun = mountRerunDialog(byId("rerun"), { onRun: on.onRun });
  const status = mountStatus(byId("status"));

  function openRerun() {
    if (!flight) return;
    void rerun.open({ flight, params: bench.params(), isTuned: bench.isChanged(), reasons, reason });
  }

  /** @param {State} state */
  function updateFrame({ shown, look, rested, ...state }) {
    const { frame, lines, lost, making, outlined, pictureFault: fault } = state;
    const awaited = shown?.status === "waiting";
    picture.update({ frame, picture: state.picture, lines, outlined, lost, awaited, making, fault });
    bench.update(benchFrameOf(id, flight, rested));
    // Stages of the frame before are pictures to look at, not this frame's reasons.
    const isLooked = shown && look && rested === frame;
    report.update({ frame: isLooked ? withLook(shown, look, bench.isChanged()) : shown, notes: [] });
  }

  return {
    columns: () => timeline.columns(),
    benchAddress: () => bench.toAddress(),
    sweepId: sweep.sweepId,
    restoreSweep: sweep.restore,
    /** How the workbench reads a frame, the run's own pad and camera aside. @param {number} frame */
    readingOf: (frame) => ({ subject: { flight: id, frame }, method: flight?.request.method ?? "dense", params: bench.params() }),
    /** @param {URLSearchParams} query */
    restoreBench(query) {
      bench.restore(query);
      void bench.start();
    },
    pictureWidth: () => byId("frame").clientWidth,
    /** @param {State} state @param {(import("./timelineLogic.js").Part & {stride: number}) | null} whole */
    update(state, whole) {
      flight = state.flight;
      const { frame, part, playing } = state;
      reason = state.reason;
      const timeS = timeOf(state);
      head.update({ flight, now: Date.now() });
      timeline.update({ timeline: state.timeline, other: state.otherTimeline, whole, part, frame, timeS });
      reasons = state.summary ? reasonsOf(state.summary) : [];
      transport.update({ frame, timeS, whole, playing, zoomed: Boolean(part), reasons, reason, loop: state.loop });
      table.update({ filter: state.filter, page: state.tablePage, frame, reasons });
      updateFrame(state);
      summary.update(state.summary ? summaryFacts(state.summary) : []);
      settings.update(flight ? settingsFacts(flight) : []);
      const hasFrames = Boolean(state.summary?.frames);
      byId("sweep").hidden = !hasFrames;
      exports.update({ enabled: hasFrames, pads: flight?.request.pads ?? [] });
      const other = state.runs.find((run) => run.id === state.compared) ?? null;
      compare.update({ flight, other, frame, picture: state.picture, lines: state.lines });
      runs.update({ flight, runs: state.runs, compared: state.compared });
      const { figures, otherFigures, coarse, otherCoarse, vehicle, pad } = state;
      const at = frame === null ? null : { frame, timeS };
      charts.update({ enabled: hasFrames, figures, otherFigures, coarse, otherCoarse, vehicle, pad, at });
      status.update(state.status);
    },
  };
}

/** @param {State} state @returns {number | null} */
function timeOf({ shown }) {
  const result = /** @type {any} */ (shown?.answer?.result);
  return result?.time_s ?? null;
}

/**
 * The frame that is on the workbench, read as the flight was.
 * @param {string} id
 * @param {State["flight"]} flight
 * @param {number | null} frame
 * @returns {import("../shared/workbench/workbench.js").Frame}
 */
function benchFrameOf(id, flight, frame) {
  const { method = "dense", params = {}, pad_name: padName = "", camera_name: cameraName = "" } = flight?.request ?? {};
  const subject = flight && frame !== null ? { flight: id, frame } : null;
  const name = sourceOf(flight, frame);
  return { subject, name, pad: "", camera: "", method, params, padName, cameraName };
}

/** The file of a frame, as a command line names it. @param {State["flight"]} flight @param {number | null} frame */
function sourceOf(flight, frame) {
  const sources = flight?.sources ?? [];
  const own = sources.filter((each) => frame !== null && each.first_frame <= frame).at(-1);
  return own?.name ?? flight?.name ?? "";
}
