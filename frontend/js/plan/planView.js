/**
 * The parts of the Plan page, and what each shows of the page's state.
 *
 * @typedef {import("./plan.js").State} State
 * @typedef {Record<string, string>} Texts
 *
 * @typedef {object} PlanEvents
 * @property {(id: string) => void} onPad
 * @property {(id: string) => void} onCamera
 * @property {(file: File) => void} onPadFile
 * @property {(file: File) => void} onCameraFile
 * @property {(method: string) => void} onMethod
 * @property {(texts: Texts) => void} onWish
 * @property {(texts: Texts) => void} onMap
 * @property {() => void} onMapStart
 * @property {() => void} onMapStop
 * @property {(texts: Texts) => void} onFrame
 * @property {() => void} onTake
 * @property {(place: {tiltDeg: number, heightMm: number}) => void} onPlace
 * @property {(place: {tiltDeg: number, heightMm: number}) => void} onAim
 * @property {(chosen: number) => void} onShot
 * @property {(texts: Texts) => void} onFly
 * @property {() => void} onFlyStart
 * @property {() => void} onFlyStop
 */

import { mountChoice } from "../shared/components/choice.js";
import { mountCoverageChart } from "./coverageChart.js";
import { mountFacts } from "../shared/components/facts.js";
import { mountFilmStrip } from "./filmStrip.js";
import { mountStatus } from "../shared/components/status.js";
import { mountSuccessMap } from "./successMap.js";
import { mountTextForm } from "../shared/components/textForm.js";
import { deadBandInWords, heightFacts, ofMethod, surenessInWords } from "../shared/coverageLogic.js";
import { cameraGroups, cameraNote, padGroups, padNote } from "../shared/readingLogic.js";
import { flyInWords, isFlown, isFlying, parseFly } from "./flyLogic.js";
import { diagnoseLink, isAsked, parseFrames } from "../shared/frameLogic.js";
import { simulationFileUrl } from "../server/planApi.js";
import { adviceFacts, designLink, dotsOf, parseMap, parseWish } from "./planLogic.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));

/** @param {PlanEvents} events */
export function makePlanView(events) {
  const padChoice = mountChoice(byId("pad-choice"), { onChoose: events.onPad, onFile: events.onPadFile });
  const cameraChoice = mountChoice(byId("camera-choice"), {
    onChoose: events.onCamera, onFile: events.onCameraFile,
  });
  const wishForm = mountTextForm(byId("wish-form"), { onInput: events.onWish });
  const facts = mountFacts(byId("advice-facts"));
  const chart = mountCoverageChart(byId("chart"), events);
  const chartFacts = mountFacts(byId("chart-facts"));
  const mapForm = mountTextForm(byId("map-form"), { onInput: events.onMap, onSubmit: events.onMapStart });
  const map = mountSuccessMap(byId("map"));
  const frameForm = mountTextForm(byId("frame-form"), { onInput: events.onFrame, onSubmit: events.onTake });
  const film = mountFilmStrip(byId("film"), { onChoose: events.onShot });
  const flyForm = mountTextForm(byId("fly-form"), { onInput: events.onFly, onSubmit: events.onFlyStart });
  const status = mountStatus(byId("status"));
  byId("method").addEventListener("change", (/** @type {Event} */ event) => {
    events.onMethod(/** @type {HTMLInputElement} */ (event.target).value);
  });
  byId("map-stop").addEventListener("click", events.onMapStop);
  byId("fly-stop").addEventListener("click", events.onFlyStop);

  /** @param {State} state */
  function updateSetup(state) {
    const { pads, stored, presets, method } = state;
    const pad = pads.find((each) => each.id === state.pad);
    const camera = [...stored, ...presets].find((each) => each.id === state.camera);
    padChoice.update({ groups: padGroups(pads), chosen: state.pad, note: padNote(pad) });
    const groups = cameraGroups(stored, presets);
    cameraChoice.update({ groups, chosen: state.camera, note: cameraNote(camera) });
    for (const input of byId("method").querySelectorAll("input")) input.checked = input.value === method;
    byId("missing").textContent = pads.length ? "" : "Save a pad on the Design page first, or upload one.";
    status.update(state.status);
  }

  /** @param {State} state */
  function updateAdvice({ wish, advice, adviceFault, advising, camera }) {
    wishForm.update({ texts: wish, errors: parseWish(wish).errors });
    facts.update(advice ? adviceFacts(advice) : []);
    byId("advice-fault").textContent = camera ? adviceFault : "";
    showNotes(byId("advice-notes"), advice?.notes ?? []);
    byId("advice-facts").setAttribute("aria-busy", String(advising));
    byId("advice-link").hidden = !advice;
    if (advice && !advising) byId("advice-link").href = designLink(advice);
    else byId("advice-link").removeAttribute("href");
  }

  /** @param {State} state */
  function updateCoverage(state) {
    const coverage = ofMethod(state.chart, state.method);
    const { wishes } = parseFrames(state.frame);
    const range = parseWish(state.wish).wish;
    chart.update({
      coverage,
      other: ofMethod(state.chart, state.method === "dense" ? "paper" : "dense"),
      wish: range && { lowMm: Number(range.low_mm), highMm: Number(range.high_mm) },
      frames: (wishes ?? []).map((each) => ({ tiltDeg: each.tilt_deg, heightMm: each.height_mm })),
      dots: dotsOf(state.map),
    });
    byId("chart-empty").hidden = Boolean(coverage);
    byId("dead-band").textContent = deadBandInWords(coverage);
    chartFacts.update(coverage ? heightFacts(coverage) : []);
    byId("chart-note").textContent = coverage ? surenessInWords(coverage.method) : "";
    const { plan, errors } = parseMap(state.mapTexts, coverage);
    mapForm.update({ texts: state.mapTexts, errors });
    byId("map-part").hidden = !coverage;
    byId("map-start").disabled = !plan || Boolean(state.mapProgress);
    byId("map-stop").hidden = !state.mapProgress;
    byId("map-progress").textContent = state.mapProgress;
    map.update({ map: state.map });
  }

  /** @param {State} state */
  function updateFrames(state) {
    const { frame, looks, grounds, pad, camera, shots, chosen, frameProgress } = state;
    fill(byId("frame-look"), looks.map(({ name, note }) => [name, `${name}: ${note}`]));
    fill(byId("frame-ground"), grounds.map((ground) => [ground, ground]));
    const { wishes, errors } = parseFrames(frame);
    frameForm.update({ texts: frame, errors });
    for (const field of byId("frame-form").querySelectorAll("[data-field]")) {
      field.hidden = !isAsked(field.dataset.field, frame.kind);
    }
    const several = (wishes?.length ?? 1) > 1;
    byId("frame-take").textContent = several ? "Take the pictures" : "Take the picture";
    byId("frame-take").disabled = !pad || !camera || Boolean(frameProgress);
    byId("frame-progress").textContent = frameProgress || (pad && camera ? "" : "Choose a pad and a camera.");
    byId("frame-diagnose").hidden = !wishes || !pad || !camera;
    byId("frame-diagnose").href = diagnoseLink(state, frame);
    film.update({ shots, chosen });
  }

  /** @param {State} state */
  function updateFlight({ fly, flyJob, looks, grounds, pad, camera }) {
    fill(byId("fly-look"), looks.map(({ name, note }) => [name, `${name}: ${note}`]));
    fill(byId("fly-ground"), grounds.map((ground) => [ground, ground]));
    flyForm.update({ texts: fly, errors: parseFly(fly).errors });
    for (const field of byId("fly-form").querySelectorAll("[data-field]")) {
      field.hidden = !isFlown(field.dataset.field, fly.flight);
    }
    byId("fly-start").disabled = !pad || !camera || isFlying(flyJob);
    byId("fly-stop").hidden = !isFlying(flyJob);
    byId("fly-progress").textContent = flyInWords(flyJob);
    const isDone = flyJob?.state === "done";
    byId("fly-open").hidden = byId("fly-files").hidden = !isDone;
    if (!isDone) return;
    byId("fly-open").href = `/flights/${flyJob.flight}`;
    byId("fly-files").href = simulationFileUrl(flyJob.id);
  }

  return {
    /** @param {State} state */
    update(state) {
      updateSetup(state);
      updateAdvice(state);
      updateCoverage(state);
      updateFrames(state);
      updateFlight(state);
    },
  };
}

/** @param {string} text */
const sentence = (text) => (text ? `${text.charAt(0).toUpperCase()}${text.slice(1)}.` : "");

/** @param {HTMLElement} root @param {string[]} notes */
function showNotes(root, notes) {
  if (root.dataset.notes === notes.join()) return;
  root.dataset.notes = notes.join();
  root.replaceChildren(
    ...notes.map((note) =>
      Object.assign(document.createElement("p"), { className: "notice notice-warn", textContent: sentence(note) }),
    ),
  );
}

/** @param {HTMLSelectElement} select @param {string[][]} options  value and text */
function fill(select, options) {
  if (select.options.length === options.length) return;
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
}
