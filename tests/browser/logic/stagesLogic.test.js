import {
  arrangeStages, channelsOf, failures, neighbour, picturedCards, reasonInWords, resultCards, runsFor,
  stageTitle, wishes,
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
const cards = arrangeStages(STAGES);

export const tests = {
  "cards follow the pipeline, channels red before blue": () => {
    equal(cards.map((card) => card.name), ["stretch", "channel", "lines", "grid", "choose"]);
    equal(cards[1].runs.map((each) => each.channel), ["red", "blue"]);
  },
  "a stage that ran twice is shown as it ended": () => {
    equal(cards[2].runs.map((each) => each.elapsed_ms), [7, 1]);
  },
  "failed stages are marked": () => {
    equal(cards.map((card) => card.failed), [false, false, false, true, true]);
  },
  "a stage unknown to the page comes last under its own name": () => {
    equal(arrangeStages([run("new_idea", null), run("pose", null)]).map((card) => card.title), ["Pose", "New idea"]);
  },
  "channels are those of the trace": () => {
    equal([channelsOf(STAGES), channelsOf([run("pose", null)])], [["red", "blue"], []]);
  },
  "failures come by channel, shared ones last": () => {
    equal(failures(STAGES).map((each) => each.channel), ["blue", null]);
  },
  "only pictures are enlarged, in order": () => {
    equal(picturedCards(cards).map((card) => card.name), ["stretch", "channel", "lines", "choose"]);
    equal(neighbour(cards, "lines", 1), "choose");
    equal(neighbour(cards, "lines", -1), "channel");
    equal([neighbour(cards, "choose", 1), neighbour(cards, "grid", 1)], [null, null]);
  },
  "a wish is fulfilled as far as the stage can": () => {
    const channels = (card, wish) => runsFor(card, wish).map((each) => each.channel);
    equal(channels(cards[1], "both"), ["red", "blue"]);
    equal(channels(cards[1], "blue"), ["blue"]);
    equal(channels(cards[0], "blue"), [null]);
    equal(channels(cards[3], "both"), []);
    equal([wishes(cards[1]), wishes(cards[0])], [["red", "blue", "both"], []]);
  },
  "the result is a card where there is a picture": () => {
    equal([resultCards("x.png").map((card) => card.name), resultCards(null)], [["result"], []]);
  },
  "reasons and stages read as words": () => {
    equal([reasonInWords("cells_too_small"), reasonInWords("odd_thing")], ["cells too small", "odd thing"]);
    equal(stageTitle("block_mean"), "Block mean");
  },
};
