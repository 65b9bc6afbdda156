/**
 * The outcome of one picture: verdict, pose in words and numbers, or where and why it failed.
 *
 * @typedef {import("../queueLogic.js").Frame} Frame
 * @typedef {import("../queueLogic.js").DetectAnswer} DetectAnswer
 * @typedef {import("../stagesLogic.js").Failure} Failure
 */

import {
  doubtInWords, evidenceFacts, isBearing, padAmongSeveral, poseAsText, poseFacts, poseInWords, qualityBadge, rangeFacts, verdict,
} from "../poseLogic.js";
import { isVideo } from "../queueLogic.js";
import { failures, findingsOf, reasonInWords, stageTitle } from "../stagesLogic.js";
import { mountCopy } from "./copy.js";
import { mountFacts } from "./facts.js";

/**
 * @param {HTMLElement} root
 * @param {{onEnlarge: () => void, onCopy: () => void, onBundle: () => Promise<void>, onTurn?: (quarter: 1 | -1) => void,
 *   onAgain?: () => void}} events
 *   pages that can turn a picture give `onTurn`: 1 is clockwise
 */
export function mountPoseReport(root, { onEnlarge, onCopy, onBundle, onTurn, onAgain }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  const image = /** @type {HTMLImageElement} */ (find("picture"));
  const pose = mountFacts(find("pose-facts"));
  const range = mountFacts(find("range-facts"));
  const evidence = mountFacts(find("evidence-facts"));
  find("enlarge").addEventListener("click", onEnlarge);
  find("copy").addEventListener("click", onCopy);
  const bundle = /** @type {HTMLButtonElement} */ (find("bundle"));
  bundle.addEventListener("click", async () => {
    // A second one while the first is made would cost the server the same again.
    bundle.disabled = true;
    await onBundle();
    bundle.disabled = false;
  });
  let copied = "";
  mountCopy(find("copy-pose"), () => copied);
  find("turn-left").addEventListener("click", () => onTurn?.(-1));
  find("turn-right").addEventListener("click", () => onTurn?.(1));
  find("again").addEventListener("click", () => onAgain?.());

  /** @param {string | null} channel @param {Failure} failure @param {string} [where] */
  function failureOf(channel, failure, where) {
    const item = /** @type {HTMLElement} */ (
      /** @type {DocumentFragment} */ (template.content.cloneNode(true)).firstElementChild
    );
    const part = (/** @type {string} */ name) =>
      /** @type {HTMLElement} */ (item.querySelector(`[data-ref=${name}]`));
    part("channel").textContent = channel ?? "";
    part("channel").className = channel ? `channel channel-${channel}` : "";
    part("where").textContent = where ?? `${stageTitle(failure.stage)}: ${reasonInWords(failure.reason)}`;
    part("detail").textContent = failure.detail;
    part("advice").textContent = failure.advice ? `Try: ${failure.advice}` : "";
    return item;
  }

  /** @param {DetectAnswer} answer */
  function failureItems({ result, trace }) {
    const found = failures(trace?.stages ?? []);
    const { stage = "", reason = "", detail = "", advice } = result;
    const isListed = found.some((each) => each.failure.detail === detail && each.failure.stage === stage);
    const isOwn = result.status === "failed" && !isListed;
    const first = isOwn ? [failureOf(null, { stage, reason, detail, advice })] : [];
    const second = findingsOf(result).map(({ where, failure }) => failureOf(null, failure, where));
    return [...first, ...second, ...found.map(({ channel, failure }) => failureOf(channel, failure))];
  }

  /** @param {DetectAnswer} answer */
  function fill(answer) {
    const { result, trace } = answer;
    const isOk = result.status === "ok";
    find("words").replaceChildren(
      ...(isOk ? poseInWords(result) : []).map((sentence) =>
        Object.assign(document.createElement("p"), { textContent: sentence }),
      ),
    );
    const items = failureItems(answer);
    find("failures").hidden = !items.length;
    find("failures-title").textContent = headOfFailures(result);
    find("failure-list").replaceChildren(...items);
    find("figures").hidden = !isOk;
    find("pose").dataset.doubtful = String(isBearing(result));
    find("doubt").textContent = doubtInWords(result);
    range.update(isOk ? rangeFacts(result) : []);
    pose.update(isOk ? poseFacts(result) : []);
    copied = isOk ? poseAsText(result) : "";
    evidence.update(isOk ? evidenceFacts(result) : []);
    const url = trace?.result_picture ?? null;
    find("enlarge").hidden = !url;
    if (url) {
      image.width = answer.image.width;
      image.height = answer.image.height;
      if (image.getAttribute("src") !== url) image.src = url;
    }
  }

  return {
    /** @param {{frame: Frame | null, notes: string[]}} state */
    update({ frame, notes }) {
      root.hidden = !frame;
      if (!frame) return;
      const { answer, status } = frame;
      root.dataset.status = status;
      const pad = answer ? padAmongSeveral(answer.result, answer.pads ?? []) : "";
      find("source").textContent = [frame.name, pad].filter(Boolean).join(" · ");
      find("verdict").textContent = headline(frame);
      const badge = answer ? qualityBadge(answer.result) : "";
      find("quality").textContent = badge;
      find("quality").hidden = !badge;
      root.dataset.quality = answer?.result.quality ?? "";
      find("busy").hidden = status !== "running";
      find("body").hidden = !answer;
      find("copy").hidden = find("bundle").hidden = !answer;
      find("refusal").textContent = status === "refused" ? frame.message : "";
      find("turn").hidden = !(onTurn && status === "refused" && frame.turned && frame.file);
      find("again").hidden = !(onAgain && status === "refused" && frame.passing);
      find("elsewhere").hidden = !(status === "refused" && isVideo(frame.name));
      find("notes").replaceChildren(
        ...notes.map((text) =>
          Object.assign(document.createElement("p"), { className: "notice notice-warn", textContent: text }),
        ),
      );
      if (answer) fill(answer);
    },
  };
}

/** @param {DetectAnswer["result"]} result @returns {string} */
function headOfFailures({ status, findings }) {
  if (status !== "ok") return "Where it failed";
  return findings ? "What to doubt" : "What was not read";
}

/** @param {Frame} frame @returns {string} */
function headline(frame) {
  if (frame.answer) return verdict(frame.answer.result);
  if (frame.status === "refused") return "The picture was not read";
  return frame.status === "running" ? "Reading the picture …" : "Waiting";
}
