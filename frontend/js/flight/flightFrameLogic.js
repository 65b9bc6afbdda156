/**
 * The frame that is shown: its result comes first, then a picture of it, then its stages.
 *
 * @typedef {import("../shared/queueLogic.js").Frame} Frame
 * @typedef {import("../server/flightsApi.js").FrameRecord} FrameRecord
 * @typedef {import("../server/flightsApi.js").FrameStages} FrameStages
 */

import { isOpen } from "../server/flightsApi.js";
import { clock, number } from "../shared/formatLogic.js";

/** @param {FrameRecord} record @returns {string} */
export function sourceInWords({ source, frame, time_s: time }) {
  const parts = [`Frame ${number(frame)}`, time === null ? "" : clock(time), source];
  return parts.filter(Boolean).join(" · ");
}

/**
 * True where there is a frame to look at: not where it could not be read from its file.
 * @param {FrameRecord} record
 */
export function hasPicture({ stage, reason }) {
  return stage !== "read" || reason === "internal_error";
}

/**
 * The state once a frame's result is there. The picture and stages of the frame before stay, marked
 * as stale, so that the page does not jump; a frame that was lost shows none.
 * @param {{shown: Frame | null, flight?: import("../server/flightsApi.js").Flight | null}} state
 * @param {number} frame
 * @param {FrameRecord | null} record  null where the frame has no result
 * @returns {{shown: Frame, stale: boolean}}
 */
export function withRecord({ shown, flight }, frame, record) {
  if (!record) {
    const status = flight && isOpen(flight) ? "waiting" : "refused";
    const message = "The flight ended before this frame was read. Try the flight again.";
    const name = `Frame ${number(frame)}`;
    return { shown: { id: name, name, file: null, status, answer: null, message }, stale: false };
  }
  const before = shown?.answer;
  const isSeen = hasPicture(record);
  const answer = {
    result: record,
    image: before?.image ?? { width: 16, height: 9 },
    camera_scale: 1,
    trace: isSeen ? (before?.trace ?? null) : null,
  };
  const name = sourceInWords(record);
  const shownNow = { id: name, name, file: null, status: record.status, answer, message: "" };
  return { shown: shownNow, stale: isSeen };
}

/**
 * The state once a frame's picture is there; the stages are still those of another frame.
 * @param {{shown: Frame | null}} state
 * @param {string} url
 * @param {{width: number, height: number}} image
 * @returns {{shown: Frame | null}}
 */
export function withPreview({ shown }, url, image) {
  const answer = shown?.answer;
  if (!answer) return { shown };
  const { id = "", stages = [] } = answer.trace ?? {};
  return { shown: { ...shown, answer: { ...answer, image, trace: { id, result_picture: url, stages } } } };
}

/**
 * The state once a frame's stages are there.
 * @param {{shown: Frame | null}} state
 * @param {number} frame
 * @param {FrameStages} stages
 * @param {{width: number, height: number}} image
 * @returns {{shown: Frame, stale: boolean}}
 */
export function withStages(state, frame, stages, image) {
  const { shown } = withRecord(state, frame, stages.result);
  const trace = { id: String(frame), result_picture: stages.result_picture, stages: stages.stages };
  const answer = { result: stages.result, image, camera_scale: 1, trace };
  return { shown: { ...shown, answer }, stale: false };
}
