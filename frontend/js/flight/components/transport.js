/**
 * The buttons and keys that go through a flight frame by frame.
 *
 * @typedef {object} TransportState
 * @property {number | null} frame
 * @property {number | null} timeS
 * @property {{first: number, last: number, stride: number} | null} whole
 * @property {boolean} playing
 * @property {boolean} zoomed
 * @property {{reason: string, text: string}[]} reasons
 * @property {string} reason  that "next failure" stops at; empty: any
 * @property {{from: number, to: number} | null} loop
 */

import { clock, number } from "../../shared/formatLogic.js";

/** Frames of a long step. */
const FAR = 10;

/**
 * @param {HTMLElement} root
 * @param {{onStep: (by: number) => void, onLoop: (end: "from" | "to" | null) => void, onFailure: (by: 1 | -1) => void, onFrame: (frame: number) => void,
 *   onPlay: () => void, onReason: (reason: string) => void, onWhole: () => void,
 *   onEnd: (end: "first" | "last") => void}} events
 */
export function mountTransport(root, events) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const any = find("reason").options[0];
  let reasons = "";
  find("previous").addEventListener("click", () => events.onStep(-1));
  find("next").addEventListener("click", () => events.onStep(1));
  find("far-back").addEventListener("click", () => events.onStep(-FAR));
  find("far-on").addEventListener("click", () => events.onStep(FAR));
  find("loop-from").addEventListener("click", () => events.onLoop("from"));
  find("loop-to").addEventListener("click", () => events.onLoop("to"));
  find("loop-off").addEventListener("click", () => events.onLoop(null));
  find("previous-failure").addEventListener("click", () => events.onFailure(-1));
  find("next-failure").addEventListener("click", () => events.onFailure(1));
  find("play").addEventListener("click", events.onPlay);
  find("whole").addEventListener("click", events.onWhole);
  find("reason").addEventListener("change", () => events.onReason(find("reason").value));
  let isTyping = false;
  find("number").addEventListener("input", () => (isTyping = true));
  find("number").addEventListener("change", () => {
    isTyping = false;
    const frame = find("number").valueAsNumber;
    if (Number.isFinite(frame)) events.onFrame(frame);
  });
  document.addEventListener("keydown", onKey);

  /** @param {KeyboardEvent} event */
  function onKey(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    // Brackets are typed with AltGr on many keyboards.
    const isCommand = (event.ctrlKey || event.metaKey || event.altKey) && !event.getModifierState("AltGraph");
    if (isCommand || document.querySelector("dialog[open]")) return;
    if (target.matches("input:not([type=radio]), select, textarea")) return;
    /** @type {Record<string, () => void>} */
    const acts = {
      ArrowLeft: () => events.onStep(event.shiftKey ? -FAR : -1),
      ArrowRight: () => events.onStep(event.shiftKey ? FAR : 1),
      g: () => find("number").select(),
      "[": () => events.onLoop("from"),
      "]": () => events.onLoop("to"),
      Home: () => events.onEnd("first"),
      End: () => events.onEnd("last"),
      n: () => events.onFailure(1),
      p: () => events.onFailure(-1),
    };
    // Space presses a button that has the focus; the ends of the page belong to who reads it.
    const isButton = target.matches("button, a, summary, input");
    if (!isButton) acts[" "] = events.onPlay;
    if (!target.matches("[role=slider]")) {
      delete acts.Home;
      delete acts.End;
    }
    if (target.matches("input[type=radio]")) return;
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** @param {TransportState["reasons"]} list */
  function fillReasons(list) {
    const key = JSON.stringify(list);
    if (key === reasons) return;
    reasons = key;
    find("reason").replaceChildren(any, ...list.map(({ reason, text }) => new Option(text, reason)));
  }

  return {
    /** @param {TransportState} state */
    update({ frame, timeS, whole, playing, zoomed, reasons: list, reason, loop }) {
      fillReasons(list);
      find("reason").value = reason;
      find("play").textContent = playing ? "Pause" : "Play";
      find("whole").hidden = !zoomed;
      find("time").textContent = timeS === null ? "" : clock(timeS);
      if (!isTyping) find("number").value = frame ?? "";
      find("number").step = whole?.stride ?? 1;
      find("number").min = whole?.first ?? 0;
      find("number").max = whole?.last ?? "";
      find("previous").disabled = !whole || frame === null || frame <= whole.first;
      find("next").disabled = !whole || frame === null || frame >= whole.last;
      find("far-back").disabled = find("previous").disabled;
      find("far-on").disabled = find("next").disabled;
      find("loop-off").hidden = !loop;
      find("loop-off").textContent = loop ? `Loop ${number(loop.from)} – ${number(loop.to)} ✕` : "";
      for (const name of ["play", "number", "loop-from", "loop-to"]) find(name).disabled = !whole;
      for (const name of ["previous-failure", "next-failure", "reason"]) find(name).disabled = !list.length;
    },
  };
}
