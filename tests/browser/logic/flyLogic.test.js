import { DEFAULT_FLY, flyInWords, isFlown, isFlying, parseFly } from "/static/js/plan/flyLogic.js";
import { contains, equal } from "./check.js";

const parse = (change) => parseFly({ ...DEFAULT_FLY, ...change });
const JOB = { id: "1", name: "x", state: "running", frames_total: 9, frames_done: 4, upload: null, flight: null, error: null };

export const tests = {
  "a landing is asked for with all of its figures": () => {
    equal(parse({ frames: "90", look: "dusk" }).spec, {
      flight: "landing", look: "dusk", ground: "grass", frames: 90, from_mm: 3000, to_mm: 100,
      fps: 30, sway: 1, seed: 1,
    });
  },
  "a flight is not asked for figures that it does not look at": () => {
    const { spec, errors } = parse({ flight: "tilts", to_mm: "", fps: "x" });
    equal(errors, {});
    equal(spec, { flight: "tilts", look: "clear", ground: "grass", frames: 60, from_mm: 3000, seed: 1 });
    equal([isFlown("to_mm", "hover"), isFlown("fps", "hover"), isFlown("seed", "tilts")], [false, true, true]);
  },
  "what cannot be is marked": () => {
    const { spec, errors } = parse({ frames: "601", to_mm: "-20", fps: "" });
    equal(spec, null);
    equal(Object.keys(errors), ["frames", "to_mm", "fps"]);
    contains(errors.frames, "from 1 to 600, whole");
    equal(Object.keys(parse({ frames: "2.5" }).errors), ["frames"]);
  },
  "how far it is": () => {
    equal(flyInWords(null), "");
    equal(flyInWords(JOB), "Frame 5 of 9 …");
    equal(flyInWords({ ...JOB, state: "queued" }), "Waits for flights before it.");
    equal(flyInWords({ ...JOB, state: "done", frames_done: 9 }), "9 frames are done.");
    equal(flyInWords({ ...JOB, state: "failed", error: { code: "a", message: "too odd" } }), "Too odd.");
    equal([isFlying(null), isFlying(JOB), isFlying({ ...JOB, state: "done" })], [false, true, false]);
  },
};
