/**
 * The frame that is shown: the flight's result, then what the workbench makes of it.
 *
 * @typedef {import("../shared/queueLogic.js").Frame} Frame
 * @typedef {import("../server/flightsApi.js").FrameRecord} FrameRecord
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
  return stage !== "read" || reason === "internal_error" || reason === "dropped_live";
}

/**
 * A frame as the report shows it.
 * @param {number} frame
 * @param {FrameRecord | null} record  null where the frame has no result
 * @param {import("../server/flightsApi.js").Flight | null} flight
 * @returns {Frame}
 */
export function shownOf(frame, record, flight) {
  if (!record) {
    const status = flight && isOpen(flight) ? "waiting" : "refused";
    const message = flight?.request.only
      ? "This run reads no other frames than some that failed in an earlier one."
      : "The flight ended before this frame was read. Try the flight again.";
    const name = `Frame ${number(frame)}`;
    return { id: name, name, file: null, status, answer: null, message };
  }
  const answer = {
    result: record, image: { width: 16, height: 9 }, camera_scale: 1, trace: null, pads: flight?.request.pads ?? [],
  };
  const name = sourceInWords(record);
  return { id: name, name, file: null, status: record.status, answer, message: "" };
}

/**
 * With the stages that the workbench shows, and its result where that was asked for otherwise than
 * the flight's.
 * @param {Frame} shown
 * @param {import("../server/tuningApi.js").Look} look  of the same frame
 * @param {boolean} isChanged
 * @returns {Frame}
 */
export function withLook(shown, look, isChanged) {
  const { answer } = shown;
  if (!answer) return shown;
  const stages = look.stages.map((run) => ({ ...run, picture: null, thumbnail: null }));
  const result = isChanged ? { ...answer.result, ...look.result, source: answer.result.source } : answer.result;
  const trace = { id: "", result_picture: null, stages };
  return { ...shown, status: result.status, answer: { ...answer, result, trace } };
}
