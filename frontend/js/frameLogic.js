/**
 * The frame that is shown: its result comes first, its stages later.
 *
 * @typedef {import("./queueLogic.js").Frame} Frame
 * @typedef {import("./flightsApi.js").FrameRecord} FrameRecord
 * @typedef {import("./flightsApi.js").FrameStages} FrameStages
 */

import { clock, number } from "./formatLogic.js";

/** @param {FrameRecord} record @returns {string} */
export function sourceInWords({ source, frame, time_s: time }) {
  const parts = [`Frame ${number(frame)}`, time === null ? "" : clock(time), source];
  return parts.filter(Boolean).join(" · ");
}

/**
 * The state once a frame's result is there. The picture and stages of the frame before stay, marked
 * as stale, so that the page does not jump.
 * @param {{shown: Frame | null}} state
 * @param {number} frame
 * @param {FrameRecord | null} record  null where the frame has no result yet
 * @returns {{shown: Frame, stale: boolean}}
 */
export function withRecord({ shown }, frame, record) {
  if (!record) {
    const message = "This frame is not read yet, or its part of the work failed.";
    const name = `Frame ${number(frame)}`;
    return { shown: { id: name, name, file: null, status: "refused", answer: null, message }, stale: false };
  }
  const before = shown?.answer;
  const answer = {
    result: record,
    image: before?.image ?? { width: 16, height: 9 },
    camera_scale: 1,
    trace: before?.trace ?? null,
  };
  const name = sourceInWords(record);
  return { shown: { id: name, name, file: null, status: record.status, answer, message: "" }, stale: true };
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
