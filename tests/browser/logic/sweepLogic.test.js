import { rangeFault, sweepChart, sweepInWords, usualRange, valuesBetween } from "/static/js/flight/sweepLogic.js";
import { equal } from "./check.js";

const param = (change = {}) => ({
  name: "search.least_step", kind: "float", default: 0.6, low: 0.1, high: 50, unit: "grey/px", not_below: null, not_above: null, ...change,
});
const sweep = (change = {}) => ({
  id: "s", parameter: "search.least_step", values: [0.3, 0.6, 1.2], state: "done", frames_total: 9, frames_done: 9,
  error: null, won: [4, 0, 0], lost: [1, 0, 2], ...change,
});

export const tests = {
  "of a sweep that was stopped before it read anything nothing is said": () => {
    equal(sweepInWords(sweep({ state: "cancelled", frames_done: 0, won: [0, 0, 0], lost: [0, 0, 0] })), "Stopped: 0 of 9 frames read.");
  },
  "a range lies about the usual value, within what is allowed": () => {
    equal(usualRange(param()), { from: 0.15, to: 2.4 });
    equal(usualRange(param({ default: 40 })), { from: 10, to: 50 });
    equal(usualRange(param({ default: -6, low: -300, high: -2, unit: "log10" })), { from: -18, to: -2 });
    equal(usualRange(param({ default: 0, low: 0, high: 1 })), { from: 0, to: 1 });
  },
  "values rise from one end to the other, as a slider has them": () => {
    const values = valuesBetween(param(), { from: 0.15, to: 2.4, count: 5 });
    equal([values.length, values[0], values[4]], [5, 0.15, 2.4]);
    equal(values.every((value, at) => at === 0 || value > values[at - 1]), true);
    // Ratios, not differences, over a wide range.
    equal(values[2] < 0.8, true);
    equal(valuesBetween(param({ kind: "int", default: 3, low: 1, high: 20 }), { from: 2, to: 4, count: 12 }), [2, 3, 4]);
    equal(valuesBetween(param({ kind: "bool" }), { from: NaN, to: NaN, count: 1 }), [false, true]);
    equal(valuesBetween(param(), { from: 1, to: 2, count: 2 }), [1, 2]);
  },
  "a range that cannot be swept is told": () => {
    const fault = (range, change) => rangeFault(param(change), { from: 0.2, to: 2, count: 5, ...range });
    equal(fault({}), "");
    equal([fault({ from: NaN }), fault({ to: 0.2 })], ["Two numbers, please.", "From must be less than to."]);
    equal([fault({ to: 51 }), fault({ count: 13 })], ["From 0.1 to 50.", "2 to 12 values."]);
    equal([fault({}, { kind: "int" }), fault({ from: NaN }, { kind: "bool" })], ["Whole numbers, please.", ""]);
  },
  "what came out is said": () => {
    equal(sweepInWords(sweep()), "0.3 wins 4 and loses 1: most of these values.");
    equal(sweepInWords(sweep({ won: [0, 0, 0] })), "No value wins more frames than it loses.");
    equal(sweepInWords(sweep({ state: "running", frames_done: 3 })), "3 of 9 frames read …");
    equal(sweepInWords(sweep({ state: "failed", error: "the file is gone" })), "the file is gone");
    equal(sweepInWords(sweep({ state: "cancelled", frames_done: 3, lost: [0, 0, 0] })), "Stopped: 3 of 9 frames read. 0.3 wins 4 and loses none: most of these values.");
  },
  "won frames stand above lost ones": () => {
    const { data } = sweepChart(sweep(), "px", (name) => name);
    equal(data.map(({ y }) => y), [[4, 0, 0], [-1, 0, -2]]);
    equal(data[0].x, ["0.3", "0.6", "1.2"]);
    equal(data[1].text, ["0.3 px: 1 frame", "0.6 px: 0 frames", "1.2 px: 2 frames"]);
  },
};
