/**
 * The parts of the Design page, and what each shows of the page's state.
 *
 * @typedef {import("./design.js").State} State
 *
 * @typedef {object} DesignEvents
 * @property {(texts: Record<string, string>) => void} onInput
 * @property {() => void} onSave
 * @property {(viewport: import("../shared/viewportLogic.js").Viewport | null) => void} onViewport
 * @property {(view: string) => void} onView
 * @property {(pair: number | null) => void} onPair
 * @property {(texts: Record<string, string>) => void} onPrint
 * @property {(x: string, y: string) => void} onMeasured
 * @property {(photo: File) => void} onStripPhoto
 * @property {() => void} onStripForget
 * @property {(camera: string) => void} onCamera
 * @property {(form: string) => void} onDownload
 * @property {(id: string) => void} onOpen
 * @property {(id: string) => void} onDelete
 * @property {(file: File) => void} onImport
 */

import { mountDownloads } from "./components/downloads.js";
import { mountFacts } from "../shared/components/facts.js";
import { mountLayerStrip } from "./components/layerStrip.js";
import { mountOptions } from "./components/options.js";
import { mountPadList } from "./components/padList.js";
import { mountPadViewer } from "./components/padViewer.js";
import { mountPrintPanel } from "./components/printPanel.js";
import { mountSheetPreview } from "./components/sheetPreview.js";
import { mountSpecForm } from "./components/specForm.js";
import { mountStatus } from "../shared/components/status.js";
import { mountVerificationPanel } from "./components/verificationPanel.js";
import { mountViewChart } from "./components/viewChart.js";
import { deadBandInWords, heightFacts, ofMethod } from "../shared/coverageLogic.js";
import { boundsInWords, padFacts, sheetInWords } from "./designLogic.js";
import { cameraGroups } from "../shared/readingLogic.js";
import { cellFacts, planFacts, rulerTexts, stripInWords } from "./printLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));

/** @param {DesignEvents} events */
export function makeDesignView(events) {
  const form = mountSpecForm(byId("spec-form"), events);
  const viewer = mountPadViewer(byId("viewer"), events);
  const strip = mountLayerStrip(byId("layer-strip"), events);
  const facts = mountFacts(byId("pad-facts"));
  const check = mountVerificationPanel(byId("verification"), events);
  const print = mountPrintPanel(byId("print-panel"), { ...events, onInput: events.onPrint });
  const sheets = mountSheetPreview(byId("sheet-preview"));
  const camera = mountOptions(byId("view-camera"), { onChoose: events.onCamera });
  const chart = mountViewChart(byId("seen"));
  const heights = mountFacts(byId("seen-heights"));
  const downloads = mountDownloads(byId("downloads"), events);
  const stripDownload = mountDownloads(byId("strip-download"), events);
  const padList = mountPadList(byId("pad-list"), events);
  const status = mountStatus(byId("status"));
  byId("pad-import").addEventListener("change", (/** @type {Event} */ event) => {
    const input = /** @type {HTMLInputElement} */ (event.target);
    const file = input.files?.[0];
    input.value = "";
    if (file) events.onImport(file);
  });

  return {
    bounds: form.bounds,
    /**
     * @param {State} state
     * @param {ReturnType<typeof import("./specLogic.js").parseSpec>} parsed
     * @param {ReturnType<typeof import("./printLogic.js").parsePrint>} printed
     */
    update(state, { spec, errors }, printed) {
      const { pad, viewport, busy, texts, saving, savedId } = state;
      form.update({
        texts,
        errors: { ...state.refused, ...errors },
        words: {
          ...boundsInWords(spec && state.bounds, form.bounds.rows.most),
          sheet: spec ? sheetInWords(spec) : "–",
        },
        saving,
      });
      const view = pad?.layers.some((each) => each.channel === state.view) ? state.view : "print";
      const invitation = spec ? "The pad is drawn here." : "Correct the marked fields to see the pad.";
      const message = state.fault || invitation;
      viewer.update({ pad, view, viewport, busy, message, pair: chosenPair(state) });
      strip.update({ pad, view });
      facts.update(pad ? padFacts(pad, savedId) : []);
      check.update({ check: state.verification, pair: state.pair, busy: state.verifying });
      print.update({ ...printState(state), errors: printed.errors });
      sheets.update({ pad, plan: state.plan });
      const { stored, presets } = state.cameras;
      camera.update({ groups: cameraGroups(stored, presets), chosen: state.camera });
      const dense = ofMethod(state.chart, "dense");
      chart.update({ pad, chart: state.chart, camera: state.camera });
      heights.update(pad && dense ? heightFacts(dense) : []);
      byId("seen-warning").textContent = pad ? deadBandInWords(dense) : "";
      const enabled = Boolean(spec ?? savedId) && !saving && Boolean(printed.options);
      downloads.update({ enabled });
      stripDownload.update({ enabled });
      byId("download-note").textContent = savedId ? "" : "A download saves the pad first.";
      padList.update({ pads: state.pads, currentId: savedId });
      status.update(state.status);
    },
  };
}

/** @param {State} state */
function printState(state) {
  const { pad, plan } = state;
  return {
    texts: state.print,
    fault: state.planFault,
    facts: [
      ...(plan ? planFacts(plan) : []),
      ...(pad ? cellFacts(pad, state.scale) : []),
    ],
    rulers: rulerTexts(state.scale),
    isSaved: Boolean(state.savedId),
    live: state.savedId ? `/live?pad=${encodeURIComponent(state.savedId)}` : "/live",
    strip: state.strip && stripInWords(state.strip),
  };
}

/** @param {State} state */
function chosenPair({ verification, pair }) {
  const near = pair === null ? null : verification?.weakest?.[pair];
  if (!near) return null;
  const windows = [
    { row: near.row, col: near.col },
    { row: near.other_row, col: near.other_col },
  ];
  return { channel: verification?.channel ?? "red", windows };
}
