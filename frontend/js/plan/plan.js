/**
 * The controller of the Plan page: it alone holds the page's state.
 *
 * @typedef {Record<string, string>} Texts
 *
 * @typedef {object} OwnState
 * @property {import("../shared/coverageLogic.js").CoverageChart | null} chart
 * @property {Texts} wish  the form of wanted heights
 * @property {import("../server/planApi.js").Advice | null} advice
 * @property {string} adviceFault
 * @property {boolean} advising  the advice shown is of an older wish; a newer one is under way
 * @property {Texts} mapTexts
 * @property {import("../server/planApi.js").SuccessMap | null} map
 * @property {string} mapProgress  empty while none is made
 * @property {Texts} frame  the form of simulated pictures
 * @property {import("./filmStrip.js").Shot[]} shots
 * @property {number} chosen  the shot that is large
 * @property {string} frameProgress
 * @property {Texts} fly  the form of a whole flight
 * @property {import("./flyLogic.js").Simulation | null} flyJob
 * @property {{name: string, note: string}[]} looks
 * @property {string[]} grounds
 * @property {import("../shared/components/status.js").Status} status
 *
 * @typedef {import("../shared/readingChoice.js").ReadingChoice & OwnState} State
 */

import { addressKeeper, readAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { isAbort, messageOf } from "../server/request.js";
import { makeLatestAnswer } from "../server/latestAnswer.js";
import { ofMethod, TILTS_DEG } from "../shared/coverageLogic.js";
import { makeFlightSimulator } from "./flightSimulator.js";
import { DEFAULT_FLY, isFlying, parseFly } from "./flyLogic.js";
import { framesFromQuery, framesToQuery, parseFrames } from "../shared/frameLogic.js";
import { makeIntake } from "../shared/intake.js";
import * as planApi from "../server/planApi.js";
import { DEFAULT_MAP, DEFAULT_WISH, fromQuery, parseMap, parseWish, toQuery } from "./planLogic.js";
import { makePlanView } from "./planView.js";
import { readingChoiceFrom } from "../shared/readingChoice.js";
import { makeSimulator } from "./simulator.js";
import { mountFooter } from "../shared/components/footer.js";
import { loadFault } from "../shared/components/status.js";

const address = readAddress();

/** @type {State} */
const state = {
  ...readingChoiceFrom(address),
  chart: null,
  wish: fromQuery(address, DEFAULT_WISH, ""),
  advice: null,
  adviceFault: "",
  advising: false,
  mapTexts: fromQuery(address, DEFAULT_MAP, "map-"),
  map: null,
  mapProgress: "",
  frame: framesFromQuery(address),
  shots: [],
  chosen: 0,
  frameProgress: "",
  fly: fromQuery(address, DEFAULT_FLY, "fly-"),
  flyJob: null,
  looks: [],
  grounds: [],
  status: null,
};

const view = makePlanView({
  onPad: (pad) => choose({ pad }),
  onCamera: (camera) => choose({ camera }),
  onPadFile: (file) => void intake.takePad(file),
  onCameraFile: (file) => void intake.takeCamera(file),
  onMethod: (method) => choose({ method }),
  onWish: (wish) => set({ wish }),
  onMap: (mapTexts) => set({ mapTexts }),
  onMapStart: () => void makeMap(),
  onMapStop: () => maps.stop(),
  onFrame: (frame) => set({ frame }),
  onTake: () => void takeFrames(),
  onPlace: (place) => {
    aim(place);
    void takeFrames();
  },
  onAim: aim,
  onShot: (chosen) => set({ chosen }),
  onFly: (fly) => set({ fly }),
  onFlyStart: () => startFlight(),
  onFlyStop: () => void flightSimulator.stop(),
});
const intake = makeIntake({
  known: () => state,
  onPad: (pad, pads) => choose({ pad, pads }),
  onCamera: (camera, cameras) => choose({ camera, ...cameras }),
  onPictures: () => set({ status: { kind: "bad", text: "Pictures are read on the Diagnose page." } }),
  onStatus: (status) => set({ status }),
});
const charts = makeLatestAnswer((/** @type {State["chart"]} */ chart, fault) => {
  set({ chart, ...(fault ? { status: { kind: "bad", text: fault } } : {}) });
});
const advisor = makeLatestAnswer((/** @type {State["advice"]} */ advice, adviceFault) => {
  set({ advice, adviceFault });
});
const frames = makeSimulator();
const maps = makeSimulator();
const flightSimulator = makeFlightSimulator({ onJob: (flyJob) => set({ flyJob }), onFault: fail });
const keepAddress = addressKeeper(toAddress);

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  keepAddress();
}

/**
 * Another pad, camera or method: what was simulated with the old one goes.
 * @param {Partial<State>} change
 */
function choose(change) {
  frames.stop();
  maps.stop();
  for (const { url } of state.shots) if (url) URL.revokeObjectURL(url);
  set({ ...change, map: null, mapProgress: "", shots: [], chosen: 0, frameProgress: "" });
}

/** @param {{tiltDeg: number, heightMm: number}} place  one picture from there */
function aim({ tiltDeg, heightMm }) {
  const place = { height_mm: String(Number(heightMm.toPrecision(3))), tilt_deg: String(Number(tiltDeg.toFixed(1))) };
  set({ frame: { ...state.frame, kind: "one", ...place } });
}

function toAddress() {
  return {
    pad: state.pad,
    camera: state.camera,
    method: state.method === "dense" ? null : state.method,
    ...toQuery(state.wish, DEFAULT_WISH, ""),
    ...toQuery(state.mapTexts, DEFAULT_MAP, "map-"),
    ...framesToQuery(state.frame),
    ...toQuery(state.fly, DEFAULT_FLY, "fly-"),
  };
}

function render() {
  const { pad, camera, method, wish } = state;
  charts.ask(pad && camera ? JSON.stringify([pad, camera]) : "", (signal) =>
    planApi.getCoverage(pad, camera, TILTS_DEG, signal),
  );
  const wanted = parseWish(wish).wish;
  const query = wanted && camera ? { ...wanted, camera, method } : null;
  advisor.ask(query ? JSON.stringify(query) : "", (signal) => planApi.getAdvice(query ?? {}, signal));
  state.advising = advisor.waits();
  view.update(state);
}

/** @param {unknown} error */
function fail(error) {
  if (!isAbort(error)) set({ status: { kind: "bad", text: messageOf(error) } });
}

async function takeFrames() {
  const { wishes } = parseFrames(state.frame);
  const { pad, camera } = state;
  if (!wishes || !pad || !camera) return;
  for (const { url } of state.shots) if (url) URL.revokeObjectURL(url);
  set({ status: null, chosen: 0 });
  try {
    await frames.takeFrames(wishes, { pad, camera }, (shots, frameProgress) =>
      set({ shots, frameProgress }),
    );
  } catch (error) {
    // Where newer pictures took their place, these are nobody's any more.
    if (isAbort(error)) return;
    set({ shots: state.shots.filter((shot) => shot.url), frameProgress: "" });
    fail(error);
  }
}

function startFlight() {
  const { spec } = parseFly(state.fly);
  const { pad, camera, method } = state;
  if (!spec || !pad || !camera || isFlying(state.flyJob)) return;
  set({ status: null });
  void flightSimulator.start({ ...spec, pad, camera, analyze: method });
}

async function makeMap() {
  const { plan } = parseMap(state.mapTexts, ofMethod(state.chart, state.method));
  const { pad, camera, method } = state;
  if (!plan || !pad || !camera) return;
  set({ map: null, status: null });
  try {
    await maps.makeMap(plan, { pad, camera, method }, (map, mapProgress) => set({ map, mapProgress }));
  } catch (error) {
    set({ mapProgress: "" });
    fail(error);
  }
}

async function start() {
  render();
  try {
    const [pads, cameras, looks] = await Promise.all([
      api.listPads(), api.listCameras(), planApi.listLooks(),
    ]);
    const isKnown = pads.items.some((each) => each.id === state.pad);
    const pad = isKnown ? state.pad : (pads.items[0]?.id ?? "");
    set({ pads: pads.items, ...cameras, pad, looks: looks.items, grounds: looks.grounds });
  } catch (error) {
    set({ status: loadFault(error) });
  }
}

void start();
mountFooter();
