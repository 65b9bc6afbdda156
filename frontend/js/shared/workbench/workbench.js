/**
 * The workbench: one frame, every stage of it, every parameter beside its stage.
 *
 * It needs `parts/workbench.html` in the page, and `workbench.css`. A page mounts it once on the
 * element `workbench`, and brings it up to date whenever the frame or how it is read changes:
 *
 *     const bench = mountWorkbench(byId("workbench"), { onChange: keepAddress, onLook, onStatus });
 *     bench.restore(readAddress());
 *     bench.update({ subject: { flight: id, frame }, name, pad: "", camera: "", method, padName, cameraName, params });
 *     const keepAddress = addressKeeper(() => ({ ...own, ...bench.toAddress() }));
 *     bench.params();  // as POST /flights/{id}/rerun and /detect take them
 *
 * A frame of a flight is read with the flight's own pad and camera where `pad` and `camera` are
 * empty; a kept picture (`{ trace }`) needs both. `params` are the settings that the frame was read
 * with before: the sliders begin there. A subject of null hides it. While frames go by quickly,
 * leave the subject as it is, and update when they stop: each subject costs the server a decoding.
 *
 * @typedef {import("../../server/tuningApi.js").Subject} Subject
 * @typedef {import("../../server/tuningApi.js").Look} Look
 * @typedef {import("./workbenchLogic.js").Place} Place
 * @typedef {import("./workbenchLogic.js").ViewName} ViewName
 *
 * @typedef {object} Frame  what a page says
 * @property {Subject | null} subject
 * @property {string} name  for the command line
 * @property {string} pad
 * @property {string[]} [others]  more pads that may be in view
 * @property {string} camera
 * @property {string} method
 * @property {string} padName
 * @property {string} cameraName
 * @property {Record<string, any>} [params]
 *
 * @typedef {object} Events
 * @property {() => void} onChange  what `toAddress` or `params` give changed
 * @property {(look: Look) => void} onLook  the frame was read under the parameters
 * @property {(status: import("../components/status.js").Status) => void} onStatus
 * @property {() => void} [onRunAgain]  the flight is to be read with these values
 */

import { listParameters } from "../../server/tuningApi.js";
import { messageOf } from "../../server/request.js";
import { mountCellsPanel } from "./cellsPanel.js";
import { NO_COMPARISON, comparisonFrom, comparisonToAddress, makeComparison } from "./comparison.js";
import { mountFocusView } from "./focusView.js";
import { makeLooker } from "./looker.js";
import { mountParamsPanel } from "./paramsPanel.js";
import { flat, nested, valuesFromText, valuesToText, withValue, withoutFaults } from "./paramsLogic.js";
import { mountStageTable } from "./stageTable.js";
import { mountTuneTools } from "./tuneTools.js";
import {
  firstFocus, keyOf, partOf, placeFromText, placeToText, viewFromText, viewToText, viewportOf,
} from "./workbenchLogic.js";

/** @param {HTMLElement} root @param {Events} events */
export function mountWorkbench(root, { onChange, onLook, onStatus, onRunAgain }) {
  const state = {
    /** @type {Frame | null} */ frame: null,
    /** @type {import("../../server/tuningApi.js").Parameter[]} */ all: [],
    /** @type {import("./paramsLogic.js").Values} */ values: {},
    /** @type {Look | null} */ look: null,
    /** @type {ViewName | null} */ focus: null,
    /** @type {Place | null} */ place: null,
    /** @type {{x: number, y: number} | null} */ cursor: null,
    opacity: 1,
    difference: false,
    .../** @type {import("./comparison.js").Comparison} */ ({ ...NO_COMPARISON, layer: "red" }),
    isBusy: false,
    fault: "",
  };
  /** @type {Map<string, import("./looker.js").Picture>} */
  const pictures = new Map();
  let wanted = /** @type {string | null} */ (null);
  /** What an address wants compared, of the frame that comes next. @type {Partial<typeof state>} */
  let awaited = {};
  /** What opened the large view by a key, and has the focus again after it. @type {HTMLElement | null} */
  let opener = null;

  const focus = mountFocusView(root, {
    onPlace: movePlace,
    onCursor: (cursor) => set({ cursor }),
    onClick: (at) => {
      comparison.click(at);
      onChange();
    },
    onBlend: (blend) => {
      set(blend);
      looker.moved();
      onChange();
    },
    onAgain: () => {
      set({ fault: "" });
      looker.again();
    },
    onLeave: () => {
      if (opener?.isConnected) opener.focus();
      opener = null;
    },
  });
  const table = mountStageTable(root, {
    onFocus: takeFocus,
    onOpen: (view, from) => {
      openView(view);
      opener = from;
    },
    onPlace: movePlace,
    onCursor: (cursor) => set({ cursor }),
  });
  const panel = mountParamsPanel(root, { onValue });
  const cells = mountCellsPanel(root, {
    onFrom: (from) => {
      comparison.choose(from);
      onChange();
    },
    onLayer: (layer) => set({ layer }),
    onCell: ({ x, y }) => movePlace({ x, y, zoom: Math.max(state.place?.zoom ?? 1, 6) }),
  });
  const tools = mountTuneTools(root, {
    onValues: (values) => {
      set({ values });
      changed(false);
    },
    onStatus,
    onRunAgain,
  });
  const looker = makeLooker({
    reading: () => (state.frame?.subject && state.all.length ? reading() : null),
    views: wishes,
    onLook: takeLook,
    onFault: (error) => set({ fault: messageOf(error) }),
    onBusy: (isBusy) => set({ isBusy }),
  });
  const comparison = makeComparison({
    state: () => state,
    reading: () => (state.frame?.subject ? reading() : null),
    set,
  });
  table.watch(() => looker.moved());
  let painting = 0;

  function reading() {
    const { subject, pad, others = [], camera, method } = /** @type {Frame} */ (state.frame);
    const given = { ...(pad ? { pad, others } : {}), ...(camera ? { camera } : {}) };
    return { subject: /** @type {Subject} */ (subject), ...given, method, params: nested(sound()) };
  }

  /** What is in force: a value out of its range waits in its field until it is mended. */
  const sound = () => withoutFaults(state.values, state.all);

  /** @param {Partial<typeof state>} change */
  function set(change) {
    Object.assign(state, change);
    painting ||= requestAnimationFrame(() => {
      painting = 0;
      render();
    });
  }

  /** @param {boolean} isDragged */
  function changed(isDragged) {
    looker.changed(isDragged);
    if (!isDragged) void comparison.ask();
    onChange();
  }

  /** @type {(parameter: import("../../server/tuningApi.js").Parameter, value: number | boolean, isDragged: boolean) => void} */
  function onValue(parameter, value, isDragged) {
    set({ values: withValue(state.values, parameter, value) });
    changed(isDragged);
  }

  /** @param {ViewName} view */
  function takeFocus(view) {
    set({ focus: view, ...(view.channel ? { layer: view.channel } : {}) });
    looker.moved();
    onChange();
  }

  /** @param {ViewName} view */
  function openView(view) {
    takeFocus(view);
    opener = null;
    if (root.hidden) return;
    root.scrollIntoView({ block: "start" });
    /** @type {HTMLElement} */ (root.querySelector("[data-ref=focus]")).focus({ preventScroll: true });
  }

  /** @param {Place | null} place */
  function movePlace(place) {
    set({ place });
    looker.moved();
    onChange();
  }

  /** @returns {import("../../server/tuningApi.js").ViewWish[]} */
  function wishes() {
    const image = state.look?.image;
    const { focus: main } = state;
    if (!image || !main) return [];
    const wish = (/** @type {ViewName} */ { stage, channel }, /** @type {{width: number, height: number}} */ size) => ({
      stage,
      channel,
      scale: viewportOf(state.place, image, size).scale * Math.min(window.devicePixelRatio || 1, 2),
      part: partOf(state.place, image, size),
      quick: false,
      marks: true,
    });
    const isBlended = state.opacity < 1 || state.difference;
    const originals = isBlended ? [...new Set([main.channel, ...table.visible().map(({ name }) => name.channel)])] : [];
    const tiles = table.visible().map(({ name, view }) => wish(name, view.size()));
    return [
      wish(main, focus.size()),
      ...originals.map((channel) => wish({ stage: "frame", channel }, focus.size())),
      // The large picture serves its tile, too.
      ...tiles.filter((tile) => keyOf(tile) !== keyOf(main)),
    ];
  }

  /** @param {Look} look @param {Map<string, import("./looker.js").Picture>} found @param {boolean} isWhole */
  function takeLook(look, found, isWhole) {
    // In haste the stages of one channel alone are there.
    const stages = isWhole || !state.look ? look.stages : [
      ...look.stages,
      ...state.look.stages.filter((old) => !look.stages.some((run) => run.name === old.name && run.channel === old.channel)),
    ];
    for (const [key, picture] of found) pictures.set(key, picture);
    const isFirst = !state.look;
    state.look = { ...look, stages };
    state.focus ??= firstFocus(look);
    set({ fault: "" });
    onLook(state.look);
    if (isFirst) render();
  }

  /** @param {ViewName} name @returns {import("./stageView.js").ViewState} */
  function viewState(name) {
    const { place, opacity, difference, cursor } = state;
    const compared = state.cells?.layers.find((each) => each.channel === state.layer) ?? null;
    const isFocus = state.focus && keyOf(name) === keyOf(state.focus);
    return {
      picture: pictures.get(keyOf(name)) ?? null,
      original: pictures.get(keyOf({ stage: "frame", channel: name.channel })) ?? null,
      place, opacity, difference, cursor,
      image: state.look?.image ?? { width: 16, height: 9 },
      cells: isFocus && compared ? { layer: compared, levels: state.cells?.levels ?? 2 } : null,
      litCell: null,
      litLine: null,
      corners: isFocus ? state.corners : [],
    };
  }

  function render() {
    const { frame, look, focus: main } = state;
    root.hidden = !frame?.subject;
    if (!frame?.subject) return;
    const stages = look?.stages ?? [];
    table.update({ stages, focus: main }, viewState);
    const run = stages.find((each) => each.name === main?.stage && each.channel === main?.channel) ?? null;
    focus.update(viewState(main ?? { stage: "frame", channel: null }), { name: main, run, isBusy: state.isBusy, fault: state.fault });
    panel.update({ all: state.all, method: frame.method, values: state.values, stage: main?.stage ?? "" });
    cells.update({
      answer: state.cells, channel: state.layer, from: state.from, corners: state.corners.length, carried: state.carried,
      hasPose: look?.result.status === "ok", hasNeighbour: "flight" in frame.subject, fault: state.cellsFault,
    });
    tools.update({ frame, values: sound(), all: state.all });
    const at = state.cursor;
    focus.showValue(at ? `x ${Math.floor(at.x)} px, y ${Math.floor(at.y)} px · ${namedValue(focus.value()) || "no picture here"}` : "");
    table.showValues(valueInWords);
  }

  return {
    /** @param {Frame} frame */
    update(frame) {
      const before = state.frame;
      state.frame = frame;
      const key = (/** @type {Frame | null} */ each) => each && JSON.stringify([each.subject, each.pad, each.others, each.camera, each.method, each.params]);
      if (key(before) === key(frame)) return set({});
      const isOther = JSON.stringify(before?.subject ?? null) !== JSON.stringify(frame.subject);
      const params = JSON.stringify(frame.params ?? {});
      if (wanted === null && params !== JSON.stringify(before?.params ?? {})) {
        const were = Object.keys(flat(before?.params ?? {}, state.all));
        const kept = Object.entries(state.values).filter(([name]) => !were.includes(name));
        state.values = { ...Object.fromEntries(kept), ...flat(frame.params ?? {}, state.all) };
      }
      if (isOther) {
        pictures.clear();
        set({ ...NO_COMPARISON, ...(frame.subject ? awaited : {}), fault: "" });
        if (frame.subject) awaited = {};
        looker.reset();
        void comparison.ask();
      } else looker.changed(false);
      set({});
    },
    /** Set one parameter. @param {string} name @param {number | boolean} value */
    take(name, value) {
      const parameter = state.all.find((each) => each.name === name);
      if (parameter) onValue(parameter, value, false);
    },
    /** Make a view the large one, and bring it before the user. @param {ViewName} view */
    open: openView,
    /** Look as an address says, at the frame that comes next. @param {URLSearchParams} query */
    restore(query) {
      wanted = query.get("set");
      awaited = comparisonFrom(query);
      if (state.all.length) {
        state.values = valuesFromText(wanted, state.all);
        wanted = null;
      }
      const opacity = Number(query.get("over") ?? 100) / 100;
      const difference = query.get("difference") === "1";
      const focus = viewFromText(query.get("view"));
      set({ focus, ...(focus?.channel ? { layer: focus.channel } : {}), place: placeFromText(query.get("at")), opacity: opacity >= 0 && opacity <= 1 ? opacity : 1, difference });
    },
    /** @returns {Record<string, string | null>} */
    toAddress: () => ({
      set: state.all.length ? valuesToText(sound()) : wanted,
      view: state.focus ? viewToText(state.focus) : null,
      at: placeToText(state.place),
      over: state.opacity < 1 ? String(Math.round(100 * state.opacity)) : null,
      difference: state.difference ? "1" : null,
      ...comparisonToAddress({ ...state, ...awaited }),
    }),
    /** How the frame is read, as the server takes it; null where there is none. */
    reading: () => (state.frame?.subject ? reading() : null),
    /** @returns {Record<string, any>} */
    params: () => nested(sound()),
    /** Whether a value differs from what the page said. */
    isChanged: () => valuesToText(sound()) !== valuesToText(flat(state.frame?.params ?? {}, state.all)),
    /** Fetch what of the detector can be tuned; once. */
    async start() {
      try {
        state.all = await listParameters();
        const given = state.frame?.params;
        state.values = wanted === null && given ? flat(given, state.all) : valuesFromText(wanted, state.all);
        wanted = null;
        looker.reset();
        void comparison.ask();
        set({});
      } catch (error) {
        set({ fault: messageOf(error) });
      }
    },
  };
}

/** @param {number[] | null} value */
function valueInWords(value) {
  if (!value) return "";
  const [red, green, blue] = value;
  return red === green && green === blue ? String(red) : `${red} ${green} ${blue}`;
}

/** @param {number[] | null} value */
function namedValue(value) {
  if (!value) return "";
  const [red, green, blue] = value;
  const isGrey = red === green && green === blue;
  return `${isGrey ? `grey ${red}` : `red ${red}, green ${green}, blue ${blue}`} of 255`;
}
