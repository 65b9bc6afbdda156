/**
 * All components of a flight's page, brought up to date together.
 *
 * @typedef {import("./flight.js").State} State
 */

import { mountCharts } from "./components/charts.js";
import { mountExportList } from "./components/exportList.js";
import { mountFacts } from "../shared/components/facts.js";
import { mountFrameTable } from "./components/frameTable.js";
import { mountFlightHead } from "./components/flightHead.js";
import { mountLightbox } from "../shared/components/lightbox.js";
import { mountPoseReport } from "../shared/components/poseReport.js";
import { mountRerunDialog } from "./components/rerunDialog.js";
import { mountRunList } from "./components/runList.js";
import { mountStageGrid } from "../shared/components/stageGrid.js";
import { mountStatus } from "../shared/components/status.js";
import { mountTimeline } from "./components/timeline.js";
import { mountTransport } from "./components/transport.js";
import { reasonsOf, settingsFacts, summaryFacts } from "./flightLogic.js";
import { arrangeStages, channelsOf, resultCards } from "../shared/stagesLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));

/**
 * @param {string} id  of the flight
 * @param {Record<string, (...values: any[]) => any>} on  events, as flight.js answers them
 */
export function makeFlightView(id, on) {
  /** @type {State["flight"]} */
  let flight = null;
  const head = mountFlightHead(byId("head"), {
    onCancel: on.onCancel,
    onRetry: on.onRetry,
    onRerun: () => flight && void rerun.open(flight),
  });
  const timeline = mountTimeline(byId("timeline"), { onSeek: on.onSeek, onPart: on.onPart });
  const transport = mountTransport(byId("transport"), {
    onStep: on.onStep,
    onFailure: on.onFailure,
    onFrame: on.onSeek,
    onPlay: on.onPlay,
    onReason: on.onReason,
    onWhole: () => on.onPart(null),
    onEnd: on.onEnd,
  });
  const table = mountFrameTable(byId("frames"), { onFilter: on.onFilter, onTurn: on.onTurn, onSeek: on.onSeek });
  const report = mountPoseReport(byId("report"), { onEnlarge: () => on.onStage("result"), onCopy: on.onCopy });
  const grid = mountStageGrid(byId("stages"), { onOpen: on.onStage });
  const lightbox = mountLightbox(byId("lightbox"), {
    onStage: (stage) => on.onLightbox({ stage, ...(stage ? {} : { viewport: null }) }),
    onWish: (wish) => on.onLightbox({ wish }),
    onViewport: (viewport) => on.onLightbox({ viewport }),
  });
  const summary = mountFacts(byId("summary"));
  const settings = mountFacts(byId("settings"));
  const exports = mountExportList(byId("downloads"), id, { onVehicle: on.onVehicle });
  const runs = mountRunList(byId("runs"), { onCompare: on.onCompare });
  const charts = mountCharts(byId("charts"), { onSeek: on.onSeek, onVisible: on.onCharts });
  const rerun = mountRerunDialog(byId("rerun"), { onRun: on.onRun });
  const status = mountStatus(byId("status"));

  /** @type {unknown} */
  let stagesShown = null;
  /** @type {import("../shared/stagesLogic.js").StageCard[]} */
  let cards = [];

  /** @param {State} state */
  function updateFrame({ shown, stale, stage, wish, viewport }) {
    const trace = shown?.answer?.trace ?? null;
    // Stages of the frame before are pictures to look at, not this frame's reasons.
    const reported = shown?.answer && stale && trace
      ? { ...shown, answer: { ...shown.answer, trace: { ...trace, stages: [] } } }
      : shown;
    report.update({ frame: reported, notes: [] });
    byId("report").toggleAttribute("data-stale", stale);
    byId("stages").toggleAttribute("data-stale", stale);
    if (trace?.stages !== stagesShown) {
      stagesShown = trace?.stages;
      cards = arrangeStages(trace?.stages ?? []);
    }
    grid.update({ cards, channels: channelsOf(trace?.stages ?? []) });
    const size = shown?.answer?.image ?? { width: 16, height: 9 };
    const all = [...cards, ...resultCards(trace?.result_picture ?? null)];
    lightbox.update({ cards: all, stage, wish, size, viewport });
  }

  return {
    columns: () => timeline.columns(),
    /** @param {State} state @param {(import("./timelineLogic.js").Part & {stride: number}) | null} whole */
    update(state, whole) {
      flight = state.flight;
      const { frame, part, playing, reason } = state;
      const timeS = timeOf(state);
      head.update({ flight, now: Date.now() });
      timeline.update({ timeline: state.timeline, other: state.otherTimeline, whole, part, frame, timeS });
      const reasons = state.summary ? reasonsOf(state.summary) : [];
      transport.update({ frame, timeS, whole, playing, zoomed: Boolean(part), reasons, reason });
      table.update({ filter: state.filter, page: state.tablePage, frame, reasons });
      updateFrame(state);
      summary.update(state.summary ? summaryFacts(state.summary) : []);
      settings.update(flight ? settingsFacts(flight) : []);
      const hasFrames = Boolean(state.summary?.frames);
      exports.update({ enabled: hasFrames });
      runs.update({ flight, runs: state.runs, compared: state.compared });
      const { figures, otherFigures, coarse, otherCoarse, padSize } = state;
      charts.update({ enabled: hasFrames, figures, otherFigures, coarse, otherCoarse, padSize });
      status.update(state.status);
    },
  };
}

/** @param {State} state @returns {number | null} */
function timeOf({ shown }) {
  const result = /** @type {any} */ (shown?.answer?.result);
  return result?.time_s ?? null;
}
