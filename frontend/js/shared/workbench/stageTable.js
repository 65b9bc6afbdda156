/**
 * The stages as a grid of linked views: those of all channels, then a row a channel, red above blue.
 *
 * @typedef {import("../../server/tuningApi.js").StageLook} StageLook
 * @typedef {import("./workbenchLogic.js").ViewName} ViewName
 */

import { duration } from "../formatLogic.js";
import { reasonInWords, stageTitle } from "../stagesLogic.js";
import { mountStageView } from "./stageView.js";
import { arrange, keyOf } from "./workbenchLogic.js";

/**
 * @param {HTMLElement} root
 * @param {object} events
 * @param {(view: ViewName) => void} events.onFocus
 * @param {(view: ViewName, from: HTMLElement) => void} events.onOpen  by the keyboard, which goes on in the large view
 * @param {(place: import("./workbenchLogic.js").Place | null) => void} events.onPlace
 * @param {(at: {x: number, y: number} | null) => void} events.onCursor
 */
export function mountStageTable(root, { onFocus, onOpen, onPlace, onCursor }) {
  const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template[data-ref=tile]"));
  /** @type {Map<string, {element: HTMLElement, view: ReturnType<typeof mountStageView>, name: ViewName}>} */
  const tiles = new Map();
  /** @type {string} */
  let arranged = "";
  /** @type {Set<string>} */
  const seen = new Set();
  /** @type {(() => void)[]} */
  const watchers = [];
  const observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      const key = /** @type {HTMLElement} */ (target).dataset.view ?? "";
      if (isIntersecting) seen.add(key);
      else seen.delete(key);
    }
    for (const tell of watchers) tell();
  }, { rootMargin: "150px" });

  /** @param {StageLook} run */
  function tileOf(run) {
    const name = { stage: run.name, channel: run.channel };
    const key = keyOf(name);
    const known = tiles.get(key);
    if (known) return known.element;
    const element = /** @type {HTMLElement} */ (/** @type {DocumentFragment} */ (template.content.cloneNode(true)).firstElementChild);
    const frame = /** @type {HTMLElement} */ (element.querySelector("[data-ref=view]"));
    const words = `${stageTitle(run.name)}${run.channel ? `, ${run.channel}` : ""}`;
    element.dataset.view = key;
    frame.setAttribute("aria-label", `${words}; Enter enlarges`);
    const open = /** @type {HTMLElement} */ (element.querySelector("[data-ref=open]"));
    open.textContent = stageTitle(run.name);
    open.setAttribute("aria-label", `Look at ${words}`);
    // A key's click has no pointer, and a detail of 0.
    open.addEventListener("click", (event) => (event.detail ? onFocus(name) : onOpen(name, open)));
    frame.addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault();
      onOpen(name, frame);
    });
    const view = mountStageView(frame, { onPlace, onCursor, onClick: () => onFocus(name) });
    observer.observe(element);
    tiles.set(key, { element, view, name });
    return element;
  }

  /** @param {StageLook} run @param {ViewName | null} focus */
  function label(run, focus) {
    const tile = tiles.get(keyOf({ stage: run.name, channel: run.channel }));
    if (!tile) return;
    const part = (/** @type {string} */ name) => /** @type {HTMLElement} */ (tile.element.querySelector(`[data-ref=${name}]`));
    const isFocus = focus?.stage === run.name && focus.channel === run.channel;
    tile.element.toggleAttribute("data-failed", Boolean(run.failure));
    tile.element.toggleAttribute("data-focus", isFocus);
    part("open").setAttribute("aria-pressed", String(isFocus));
    part("failure").textContent = run.failure ? reasonInWords(run.failure.reason) : "";
    part("failure").title = run.failure?.detail ?? "";
    part("time").textContent = run.elapsed_ms ? duration(run.elapsed_ms) : "";
  }

  /** @param {StageLook[]} stages */
  function build(stages) {
    const { columns, shared, rows } = arrange(stages);
    const key = JSON.stringify([columns, shared.map((run) => run.name), rows.map((row) => [row.channel, row.runs.map(Boolean)])]);
    if (key === arranged) return;
    arranged = key;
    find("shared").replaceChildren(...shared.map(tileOf));
    const lines = rows.map(({ channel, runs }) => {
      const line = document.createElement("div");
      line.className = `stage-row stage-row-${channel}`;
      line.setAttribute("role", "group");
      line.setAttribute("aria-label", `${channel} channel`);
      const head = Object.assign(document.createElement("span"), { className: `channel channel-${channel} stage-row-name`, textContent: channel });
      line.append(head, ...runs.map((run) => (run ? tileOf(run) : unreached())));
      return line;
    });
    find("rows").replaceChildren(...lines);
    const kept = new Set(stages.map((run) => keyOf({ stage: run.name, channel: run.channel })));
    for (const [name, { element }] of tiles) {
      if (kept.has(name)) continue;
      observer.unobserve(element);
      seen.delete(name);
      tiles.delete(name);
    }
  }

  return {
    /** Told when other tiles come into view. @param {() => void} tell */
    watch: (tell) => watchers.push(tell),
    /** Those on the screen. */
    visible: () => [...tiles.values()].filter(({ element }) => seen.has(element.dataset.view ?? "")),
    /**
     * @param {{stages: StageLook[], focus: ViewName | null}} state
     * @param {(name: ViewName) => import("./stageView.js").ViewState} stateOf
     */
    update({ stages, focus }, stateOf) {
      build(stages);
      for (const run of stages) label(run, focus);
      for (const { view, name } of tiles.values()) view.update(stateOf(name));
    },
    /** Write what every view has under the cursor. @param {(value: number[] | null) => string} words */
    showValues(words) {
      for (const { element, view } of tiles.values()) {
        const text = words(view.value());
        const place = /** @type {HTMLElement} */ (element.querySelector("[data-ref=value]"));
        if (place.textContent !== text) place.textContent = text;
      }
    },
  };
}

const unreached = () =>
  Object.assign(document.createElement("p"), { className: "stage-blank", textContent: "not reached" });
