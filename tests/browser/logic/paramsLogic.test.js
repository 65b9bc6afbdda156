import {
  boundsOf, byStage, commandLine, faultOf, flat, nested, positionOf, replaceQuestion, STEPS, valueAt, valuesFromText, valuesToText, withValue, withoutFaults,
} from "/static/js/shared/workbench/paramsLogic.js";
import { contains, equal } from "./check.js";

const param = (name, change = {}) => ({
  name, group: name.includes(".") ? name.split(".")[0] : "", kind: "float", default: 1, low: 0, high: 10, not_below: null, not_above: null,
  unit: "", text: "", stages: ["edges"], methods: ["dense"], followed: false, ...change,
});
const STEP = param("search.least_step", { default: 0.6, low: 0.1, high: 50 });
const MOST = param("refine.most_borders", { kind: "int", default: 3000, low: 50, high: 1_000_000, stages: ["pose"] });
const FEW = param("refine.few_borders", { kind: "int", default: 300, low: 50, high: 1_000_000, not_above: "most_borders", stages: ["pose"] });
const CHANCE = param("log10_false_alarm", { default: -6, low: -300, high: -2, unit: "log10", stages: ["choose"] });
const UNMIX = param("prepare.unmix", { kind: "bool", default: true, low: 0, high: 1, methods: ["dense", "paper"] });
const GAP = param("paper.hough_gap", { default: 0.015, low: 0, high: 0.5, methods: ["paper"], stages: ["lines"] });
const ALL = [STEP, MOST, FEW, CHANCE, UNMIX, GAP];

export const tests = {
  "a slider's ends are the range's, and its place comes back": () => {
    for (const each of [STEP, MOST, GAP]) {
      equal([valueAt(each, 0), valueAt(each, STEPS)], [each.low, each.high]);
      const value = valueAt(each, 437);
      equal(Math.abs(positionOf(each, value) - 437) <= 2, true);
    }
    equal(valueAt(CHANCE, 0), -60);
  },
  "small values have room on a wide range": () => {
    equal(positionOf(STEP, 0.6) > 200, true);
    equal(positionOf(GAP, 0.015) > 200, true);
    equal(Number.isInteger(valueAt(MOST, 333)), true);
  },
  "a value that is its default is no change": () => {
    const values = withValue({}, STEP, 0.4);
    equal(values, { "search.least_step": 0.4 });
    equal(withValue(values, STEP, 0.6), {});
  },
  "a preset takes another's name only when asked, whatever the method": () => {
    const kept = { name: "faint", method: "dense", params: { search: { least_step: 0.4, least_edges: 20 } } };
    const same = { ...kept, params: { search: { least_edges: 20, least_step: 0.4 } } };
    equal([replaceQuestion(same, [kept]), replaceQuestion({ ...kept, name: "new" }, [kept]), replaceQuestion(kept, [])], ["", "", ""]);
    contains(replaceQuestion({ ...kept, params: {} }, [kept]), "with other values");
    contains(replaceQuestion({ ...kept, method: "paper" }, [kept]), "method dense");
  },
  "values nest as the server takes them, and come back": () => {
    const values = { "search.least_step": 0.4, log10_false_alarm: -8, "prepare.unmix": false };
    const params = { log10_false_alarm: -8, prepare: { unmix: false }, search: { least_step: 0.4 } };
    equal(nested(values), params);
    equal(Object.keys(flat(params, ALL)).sort(), Object.keys(values).sort());
    equal(flat({ search: { least_step: 0.6 } }, ALL), {});
  },
  "a link holds the changes; what it names wrongly is left out": () => {
    const text = valuesToText({ "search.least_step": 0.4, "prepare.unmix": false });
    equal(text, "search.least_step:0.4~prepare.unmix:false");
    equal(valuesFromText(text, ALL), { "search.least_step": 0.4, "prepare.unmix": false });
    equal(valuesFromText("search.least_step:900~nothing:3~refine.most_borders:1.5~<b>:1", ALL), {});
    equal([valuesToText({}), valuesFromText(null, ALL)], [null, {}]);
  },
  "a bound may be another parameter": () => {
    equal(boundsOf(FEW, { "refine.most_borders": 100 }, ALL), [50, 100]);
    equal(faultOf(FEW, 300, { "refine.most_borders": 100 }, ALL), "From 50 to 100.");
    equal([faultOf(FEW, 300, {}, ALL), faultOf(FEW, 1.5, {}, ALL), faultOf(STEP, NaN, {}, ALL)], ["", "A whole number, please.", "A number, please."]);
  },
  "a value that another has for its bound keeps to that one's value": () => {
    equal(boundsOf(MOST, {}, ALL), [300, 1_000_000]);
    equal(boundsOf(MOST, { "refine.few_borders": 60 }, ALL), [60, 1_000_000]);
  },
  "only what can stand together is in force": () => {
    const step = { "search.least_step": 0.4 };
    equal(withoutFaults({ ...step, "refine.most_borders": 100 }, ALL), step);
    equal(withoutFaults({ ...step, "refine.most_borders": 100, "refine.few_borders": 60 }, ALL), { ...step, "refine.most_borders": 100, "refine.few_borders": 60 });
    equal(withoutFaults({ ...step, "refine.most_borders": 1.5, "refine.few_borders": 400 }, ALL), step);
    equal(withoutFaults({ "search.least_step": NaN }, ALL), {});
    equal(valuesFromText("refine.most_borders:100", ALL), {});
    equal(valuesFromText("refine.few_borders:60~refine.most_borders:100", ALL), { "refine.few_borders": 60, "refine.most_borders": 100 });
  },
  "the command line says only what differs, and quotes what needs it": () => {
    const reading = { pad: "my pad.json", camera: "cam.yaml", method: "dense", source: "f.jpg", values: { "search.least_step": 0.4 } };
    equal(commandLine(reading), "padstudio detect --pad 'my pad.json' --camera cam.yaml --param search.least_step=0.4 f.jpg -o poses.jsonl");
    equal(commandLine({ ...reading, method: "paper", values: {} }).includes("--method paper f.jpg"), true);
  },
  "parameters stand at their first stage, those of the method alone": () => {
    equal(byStage(ALL, "dense", ["edges", "choose", "pose", "lines"]).map(({ stage, items }) => [stage, items.length]),
      [["edges", 2], ["choose", 1], ["pose", 2]]);
  },
};
