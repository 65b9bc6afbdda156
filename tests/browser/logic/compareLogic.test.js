import {
  changeInWords, changesChart, comparisonInWords, figuresOf, resultInWords,
} from "/static/js/flight/compareLogic.js";
import { equal } from "./check.js";

const found = (change = {}) => ({
  frames: 210, only_first: 0, only_second: 0, won: 13, lost: 3, both: 190, neither: 4,
  moved: { median_mm: 0.0213, p95_mm: 0.9, worst_mm: 14.1, worst_share: 0.011, worst_frame: 55 }, columns: [], ...change,
});
const change = (values = {}) => ({ frame: 5, kind: "both", moved_mm: 0.4, moved_share: 0.0004, turned_deg: 0.02, ...values });

export const tests = {
  "two runs in sentences": () => {
    equal(comparisonInWords(found()), [
      "Of 210 frames that both runs read, this one wins 13 and loses 3; 190 have a pose in both, 4 in neither.",
      "Poses in both lie 0.021 mm apart (median), at most 14.1 mm, 1 % of the distance, in frame 55.",
    ]);
    equal(comparisonInWords(found({ frames: 0 })), ["The runs have no frame in common."]);
    equal(comparisonInWords(found({ moved: null, only_first: 20 }))[1], "Left out: 20 frames in the other run alone.");
  },
  "what became of a frame": () => {
    equal(["won", "lost", "neither"].map((kind) => changeInWords(change({ kind })).word), ["won", "lost", "no pose in either"]);
    equal([changeInWords(change()).kind, changeInWords(change({ moved_mm: 1 })).kind], ["same", "moved"]);
    equal(figuresOf(change()), { moved: "0.4 mm", share: "0.04 %", turned: "0.02°" });
    equal(figuresOf(change({ moved_mm: null, moved_share: null, turned_deg: null })), { moved: "", share: "", turned: "" });
  },
  "a result in a few words": () => {
    equal(resultInWords({ status: "failed", stage: "grid", reason: "no_lattice" }), "Grid: no lattice");
    equal(resultInWords({ status: "ok", layer: "red", position_mm: [0, 0, 812], quality: "full" }), "red, 812 mm high");
    equal(resultInWords({ status: "ok", layer: "outline", position_mm: [0, 0, 812], quality: "bearing" }), "outline, bearing only, 812 mm high");
  },
  "won frames stand above lost ones, each column leads to its first": () => {
    const columns = [{ first_frame: 0, last_frame: 9, won: 2, lost: 1 }, { first_frame: 10, last_frame: 10, won: 0, lost: 0 }];
    const { data } = changesChart(found({ columns }), (name) => name);
    equal(data.map(({ y }) => y.map((count) => count || 0)), [[2, 0], [-1, 0]]);
    equal([data[0].customdata, data[0].text], [[0, 10], ["frames 0 to 9: 2 frames", "frame 10: 0 frames"]]);
  },
};
