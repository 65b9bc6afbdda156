/**
 * Stage pictures enlarged, the channels side by side under one zoom.
 *
 * @typedef {import("../stagesLogic.js").StageCard} StageCard
 * @typedef {import("../stagesLogic.js").StageAnswer} StageAnswer
 * @typedef {import("../viewportLogic.js").Viewport} Viewport
 *
 * @typedef {object} LightboxState
 * @property {StageCard[]} cards
 * @property {string | null} stage  null: closed
 * @property {string} wish  a channel or "both"
 * @property {{width: number, height: number}} size  of the frame, pixels
 * @property {Viewport | null} viewport  in pixels of the frame; null: the whole picture
 */

import { duration } from "../formatLogic.js";
import { neighbour, reasonInWords, runsFor, wishes } from "../stagesLogic.js";
import { clamp, fit, toView, zoomAt } from "../viewportLogic.js";
import { makeZoomable } from "./zoomable.js";

const MAX_SCALE = 40;
const CRISP_FROM = 2;

/**
 * @param {HTMLDialogElement} dialog
 * @param {{onStage: (stage: string | null) => void, onWish: (wish: string) => void,
 *   onViewport: (viewport: Viewport | null) => void}} events
 */
export function mountLightbox(dialog, { onStage, onWish, onViewport }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (dialog.querySelector(`[data-ref=${name}]`));
  const panes = [...dialog.querySelectorAll(".lightbox-pane")].map((element) => ({
    element: /** @type {HTMLElement} */ (element),
    image: /** @type {HTMLImageElement} */ (element.querySelector("img")),
    caption: /** @type {HTMLElement} */ (element.querySelector("figcaption")),
    frame: /** @type {HTMLElement} */ (element.querySelector(".lightbox-frame")),
  }));
  /** @type {LightboxState} */
  let state = { cards: [], stage: null, wish: "both", size: { width: 16, height: 9 }, viewport: null };

  const viewSize = () => ({
    width: panes[0].frame.clientWidth,
    height: panes[0].frame.clientHeight,
  });
  const current = () => state.viewport ?? fit(state.size, viewSize());
  const change = (/** @type {Viewport} */ viewport) =>
    onViewport(clamp(viewport, state.size, viewSize(), MAX_SCALE));
  const zoom = (/** @type {number} */ factor) => change(zoomAt(current(), factor, { x: 0, y: 0 }));
  const step = (/** @type {1 | -1} */ by) => {
    const next = state.stage && neighbour(state.cards, state.stage, by);
    if (next) onStage(next);
  };
  const card = () => state.cards.find((candidate) => candidate.name === state.stage);

  function place() {
    const viewport = current();
    const { width, height } = state.size;
    const view = viewSize();
    for (const { image } of panes) {
      const corner = toView(viewport, { x: 0, y: 0 });
      const x = corner.x + view.width / 2;
      const y = corner.y + view.height / 2;
      image.style.transform = `translate(${x}px, ${y}px) scale(${viewport.scale})`;
      // A stage may work on a smaller picture: all are laid over the frame's own pixels.
      image.style.width = `${width}px`;
      image.style.height = `${height}px`;
      const magnified = (viewport.scale * width) / (image.naturalWidth || width);
      image.style.imageRendering = magnified >= CRISP_FROM ? "pixelated" : "auto";
    }
    find("zoom").textContent = `${Math.round(viewport.scale * 100)} %`;
  }

  /** @param {StageCard} shown */
  function fill(shown) {
    const runs = runsFor(shown, state.wish);
    find("title").textContent = shown.title;
    find("about").textContent = shown.about;
    panes.forEach((pane, at) => {
      const run = runs[at];
      pane.element.hidden = !run;
      if (!run?.picture) return;
      if (pane.image.getAttribute("src") !== run.picture) pane.image.src = run.picture;
      pane.image.alt = `${shown.title}${run.channel ? `, ${run.channel} channel` : ""}`;
      pane.caption.textContent = captionOf(run);
    });
    const choices = wishes(shown);
    const kept = choices.includes(state.wish) ? state.wish : (runs[0]?.channel ?? "");
    find("wishes").hidden = !choices.length;
    for (const input of find("wishes").querySelectorAll("input")) {
      input.checked = input.value === kept;
      /** @type {HTMLElement} */ (input.parentElement).hidden = !choices.includes(input.value);
    }
    find("previous").toggleAttribute("disabled", !neighbour(state.cards, shown.name, -1));
    find("next").toggleAttribute("disabled", !neighbour(state.cards, shown.name, 1));
  }

  function nextWish() {
    const shown = card();
    const choices = shown ? wishes(shown) : [];
    if (choices.length) onWish(choices[(choices.indexOf(state.wish) + 1) % choices.length]);
  }

  /** @param {KeyboardEvent} event */
  function onKey(event) {
    const inChoice = event.target instanceof HTMLInputElement;
    if (event.ctrlKey || event.metaKey || event.altKey || inChoice) return;
    /** @type {Record<string, () => void>} */
    const always = {
      PageDown: () => step(1),
      PageUp: () => step(-1),
      c: nextWish,
    };
    // Arrows turn the pages of whole pictures, and move a picture that is zoomed.
    const whole = { ArrowRight: () => step(1), ArrowLeft: () => step(-1) };
    const act = { ...always, ...(state.viewport ? {} : whole) }[event.key];
    if (act) {
      event.preventDefault();
      event.stopPropagation();
      act();
    }
  }

  dialog.addEventListener("keydown", onKey, { capture: true });
  // The browser closes a dialog on Escape by itself; the state follows.
  dialog.addEventListener("close", () => onStage(null));
  find("close").addEventListener("click", () => dialog.close());
  find("previous").addEventListener("click", () => step(-1));
  find("next").addEventListener("click", () => step(1));
  find("zoom-in").addEventListener("click", () => zoom(1.5));
  find("zoom-out").addEventListener("click", () => zoom(1 / 1.5));
  find("zoom-fit").addEventListener("click", () => onViewport(null));
  find("wishes").addEventListener("change", (event) => {
    onWish(/** @type {HTMLInputElement} */ (event.target).value);
  });
  for (const { frame, image } of panes) {
    makeZoomable(frame, { current, change, reset: () => onViewport(null) });
    image.addEventListener("load", place);
    new ResizeObserver(place).observe(frame);
  }

  return {
    /** @param {LightboxState} next */
    update(next) {
      state = next;
      const shown = card();
      if (!shown) {
        if (dialog.open) dialog.close();
        return;
      }
      fill(shown);
      if (!dialog.open) {
        dialog.showModal();
        panes[0].frame.focus();
      }
      place();
    },
  };
}

/** @param {StageAnswer} run @returns {string} */
function captionOf(run) {
  const parts = [run.channel ?? "", run.elapsed_ms ? duration(run.elapsed_ms) : ""];
  if (run.failure) parts.push(`${reasonInWords(run.failure.reason)}: ${run.failure.detail}`);
  return parts.filter(Boolean).join(" · ");
}
