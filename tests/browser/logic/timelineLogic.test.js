import {
  columnInWords, columnOf, frameAt, heightMarks, heightRange, nearestFrame, partFromText, partToText, partWith,
  placeOf, tallyOf, timelineInWords, wholeOf, zoomPart,
} from "/static/js/flight/timelineLogic.js";
import { equal, near } from "./check.js";

const whole = { first: 10, last: 1009, stride: 1 };
const column = (at, outcomes, z = [null, null]) => ({
  column: at, first_frame: 10 * at, last_frame: 10 * at + 9, time_s: at, z_min_mm: z[0], z_max_mm: z[1],
  outcomes, stages: {},
});
const timeline = {
  first_frame: 0, last_frame: 39, frames_per_column: 10,
  columns: [column(0, [10, 0, 0, 0, 0], [900, 1000]), column(1, [4, 0, 2, 0, 4], [800, 850]), column(3, [0, 0, 0, 0, 10])],
};

export const tests = {
  "the whole is what the flight reads of its files": () => {
    const sources = [{ frames: 60 }, { frames: 40 }];
    equal(wholeOf({ request: {}, sources }), { first: 0, last: 99, stride: 1 });
    equal(wholeOf({ request: { first_frame: 5, end_frame: 90, stride: 10 }, sources }), { first: 5, last: 85, stride: 10 });
    equal(wholeOf({ request: { end_frame: 9999 }, sources }).last, 99);
    equal([wholeOf({ request: {} }), wholeOf({ request: {}, sources: [] })], [null, null]);
  },
  "a place and its frame belong together": () => {
    for (const frame of [10, 11, 500, 1009]) equal(frameAt(whole, placeOf(whole, frame), whole), frame);
    equal([frameAt(whole, 0, whole), frameAt(whole, 1, whole)], [10, 1009]);
    const every = { first: 3, last: 33, stride: 10 };
    equal([nearestFrame(-5, every), nearestFrame(9, every), nearestFrame(99, every)], [3, 13, 33]);
  },
  "zooming keeps the frame under the pointer, and ends at the whole": () => {
    const part = zoomPart(whole, 4, 0.25, whole);
    equal(part.last - part.first + 1, 250);
    near(part.first + 0.25 * 250, 10 + 0.25 * 1000, 1);
    equal(zoomPart(part, 0.1, 0.5, whole), null);
    const least = zoomPart({ first: 100, last: 119 }, 100, 0.5, whole);
    equal(least.last - least.first + 1, 20);
    equal(zoomPart(whole, 4, 1, whole).last, 1009);
  },
  "a flight shorter than the least part is not zoomed": () => {
    const short = { first: 0, last: 7, stride: 1 };
    equal(zoomPart(short, 2, 0.5, short), null);
  },
  "the part follows the frame, as little as needed": () => {
    const part = { first: 100, last: 199 };
    equal(partWith(part, 150, whole), part);
    equal(partWith(part, 205, whole), { first: 155, last: 254 });
    equal(partWith(part, 1009, whole), { first: 910, last: 1009 });
    equal(partWith(null, 5, whole), null);
  },
  "a part in the address": () => {
    equal(partFromText(partToText({ first: 3, last: 90 })), { first: 3, last: 90 });
    for (const text of [null, "", "3", "9-3", "-1-4", "a-b"]) equal(partFromText(text), null);
    equal(partToText(null), null);
  },
  "columns are found by frame, empty ones are not there": () => {
    equal([columnOf(timeline, 17).column, columnOf(timeline, 25), columnOf(timeline, 39).column], [1, undefined, 3]);
  },
  "a column in words": () => {
    equal(columnInWords(timeline.columns[0], 3), "frames 0 – 9 · 0:00.00 · 900 mm – 1000 mm · all 10 with a pose");
    equal(columnInWords(timeline.columns[1], 12), "frames 10 – 19 · 0:01.00 · 800 mm – 850 mm · 4 without a pose");
    const single = { ...column(0, [0, 0, 1, 0, 0], [50, 50]), last_frame: 0 };
    equal(columnInWords(single, 0), "frame 0 · 0:00.00 · 50.0 mm · blue");
    const far = { ...column(0, [0, 0, 0, 0, 0, 1], [50, 50]), last_frame: 0 };
    equal(columnInWords(far, 0), "frame 0 · 0:00.00 · 50.0 mm · range and bearing only");
    equal(columnInWords(column(0, [2, 0, 0, 0, 3, 5]), 1),
      "frames 0 – 9 · 0:00.00 · 3 without a pose · 5 with range and bearing only");
    equal(columnInWords(undefined, 25), "frame 25: not read");
  },
  "heights span the columns of all runs, with the ground": () => {
    equal(heightRange(timeline.columns), { low: 0, high: 1000 });
    equal(heightRange(timeline.columns, [column(0, [1], [-5, 2000])]), { low: -5, high: 2000 });
    equal(heightRange([timeline.columns[2]]), null);
    equal(heightMarks({ low: 0, high: 1000 }), [0, 500, 1000]);
    equal(heightMarks({ low: 0, high: 3500 }), [0, 1000, 2000, 3000]);
  },
  "tallies": () => {
    equal(tallyOf(timeline), { ok: 16, count: 30 });
    equal(timelineInWords(timeline), "30 frames shown, 53 % with a pose");
  },
};
