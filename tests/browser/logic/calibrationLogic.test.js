import {
  coverageCells, factsOf, isAtWork, missingInWords, parameterRow, pictureInWords, progressInWords, sigmaCells, verdictOf,
} from "/static/js/cameras/calibrationLogic.js";
import { equal } from "./check.js";

const picture = (change = {}) => ({
  name: "a.jpg", used: true, state: "good", message: "", patches: 1412, rms_px: 0.0612, range_mm: 1431.2, tilt_deg: 24.7, ...change,
});
const result = (change = {}) => ({
  width: 1920, height: 1080, model: "radtan", intrinsics: [], distortion: [], rms_px: 0.0594,
  sigma_px: [[0.1, null], [0.42, 0.2]], coverage: [[0, 4], [1, 16]], pictures: [picture()], findings: [], ...change,
});

export const tests = {
  "a job is at work until it is over": () => {
    const states = ["queued", "running", "done", "failed", "cancelled"];
    equal(states.map((state) => isAtWork({ state })), [true, true, false, false, false]);
    equal(isAtWork(null), false);
  },
  "its progress is told": () => {
    equal(progressInWords({ state: "queued", steps_done: 0, steps_total: 0 }), "Waiting for a free worker …");
    equal(progressInWords({ state: "running", steps_done: 0, steps_total: 0 }), "Reading the pictures …");
    equal(progressInWords({ state: "running", steps_done: 7, steps_total: 41 }), "Step 7 of at most 41");
  },
  "an order says what it lacks": () => {
    equal(missingInWords({ pad: "", files: 2 }), "Choose the pad that was printed.");
    equal(missingInWords({ pad: "p", files: 0 }), "Add stills or a clip of it.");
    equal(missingInWords({ pad: "p", files: 3 }), "");
  },
  "a good calibration is called so, and only that": () => {
    equal(verdictOf(result()), { kind: "ok", text: "A good calibration: residuals are 0.06 px, and nothing is missing." });
    const bad = verdictOf(result({ findings: [{ code: "few_pictures", message: "" }], pictures: [picture(), picture({ state: "rough" })] }));
    equal(bad, { kind: "warn", text: "Residuals are 0.06 px; one thing is missing, and one picture should be taken again." });
  },
  "its facts count pictures and name the least sure part": () => {
    const facts = Object.fromEntries(factsOf(result({ pictures: [picture(), picture({ used: false })] })));
    equal(facts.Pictures, "1 of 2 used");
    equal(facts["Least sure part"], "± 0.42 px");
  },
  "parameters have units where they have any": () => {
    equal(parameterRow({ name: "fx", value: 1402.511, sigma: 0.2149 }), ["fx", "1402.51 px", "± 0.21 px"]);
    equal(parameterRow({ name: "k1", value: -0.27141, sigma: 0.0008 }), ["k1", "-0.27141", "± 0.00080"]);
  },
  "a picture says where it was taken from": () => {
    equal(pictureInWords(picture()).startsWith("from 1431 mm, leaning 25° · "), true);
    equal(pictureInWords(picture({ used: false })).includes("points"), false);
    equal(pictureInWords(picture({ range_mm: null, tilt_deg: null })), "");
  },
  "maps are drawn part by part": () => {
    const cells = coverageCells([[0, 4], [1, 16]]);
    equal(cells.map(({ x, y, opacity }) => [x, y, opacity]), [[0, 0, 0], [1, 0, 0.5], [0, 1, 0.25], [1, 1, 1]]);
    equal(cells[2].title, "1 point");
    const sigma = sigmaCells([[0.1, null, 3]]);
    equal(sigma.map(({ opacity }) => opacity), [0.1 / 3, 0, 1]);
    equal(sigmaCells([[0.1]])[0].opacity, 0.2);
    equal(sigma[0].title, "± 0.1 px");
  },
};
