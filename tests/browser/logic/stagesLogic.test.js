import {
  failures, findingsOf, reasonInWords, stageAbout, stagesOf, stageTitle,
} from "/static/js/shared/stagesLogic.js";
import { equal } from "./check.js";

const FAILURE = { stage: "grid", reason: "no_lattice", detail: "3 of 40", advice: "" };
const run = (name, channel, change = {}) =>
  ({ name, channel, elapsed_ms: 1, failure: null, picture: `${channel}-${name}`, thumbnail: null, ...change });
const STAGES = [
  run("stretch", null),
  run("lines", "blue"),
  run("lines", "red", { picture: null }),
  run("channel", "blue"),
  run("channel", "red"),
  run("grid", "blue", { failure: FAILURE, picture: null }),
  run("choose", null, { failure: { ...FAILURE, stage: "choose" } }),
  run("lines", "red", { elapsed_ms: 7 }),
];

export const tests = {
  "findings stand beside a failure, and are doubts of a pose": () => {
    const findings = [{ reason: "defocus", detail: "9 px", advice: "focus" }];
    equal(findingsOf({ status: "failed", findings }).map(({ where }) => where), ["Also: out of focus"]);
    equal(findingsOf({ status: "ok", findings }).map(({ where }) => where), ["Doubt: out of focus"]);
    equal(findingsOf({ status: "ok" }), []);
  },
  "failures come by channel, shared ones last": () => {
    equal(failures(STAGES).map((each) => each.channel), ["blue", null]);
  },
  "an answer without a trace has no stages": () => {
    equal(stagesOf({ trace: { stages: STAGES } }).length, STAGES.length);
    equal([stagesOf(null), stagesOf({ trace: null })], [[], []]);
  },
  "reasons and stages read as words": () => {
    equal([reasonInWords("cells_too_small"), reasonInWords("odd_thing")], ["cells too small", "odd thing"]);
    equal(stageTitle("block_mean"), "Block mean");
    equal([stageTitle("new_idea"), stageAbout("new_idea")], ["New idea", ""]);
  },
};
