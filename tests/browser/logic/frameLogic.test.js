import {
  DEFAULT_FRAME, diagnoseLink, frameInWords, frameName, framesFromQuery, framesToQuery, isAsked,
  parseFrames, truthFacts,
} from "/static/js/shared/frameLogic.js";
import { contains, equal, near } from "./check.js";

const parse = (change) => parseFrames({ ...DEFAULT_FRAME, ...change });

export const tests = {
  "one picture is where the form says": () => {
    const { wishes, errors } = parse({ height_mm: "640.5", tilt_deg: "12", look: "dusk" });
    equal(errors, {});
    equal(wishes.length, 1);
    const [{ height_mm, tilt_deg, heading_deg, tilt_towards_deg, look, seed }] = wishes;
    equal([height_mm, tilt_deg, heading_deg, tilt_towards_deg, look, seed], [640.5, 12, 30, 30, "dusk", 1]);
  },
  "a descent goes down in even ratios, each with a heading and noise of its own": () => {
    const { wishes } = parse({ kind: "descent", height_mm: "1600", to_mm: "100", frames: "5" });
    equal(wishes.map((wish) => wish.height_mm), [1600, 800, 400, 200, 100]);
    equal(new Set(wishes.map((wish) => wish.heading_deg)).size, 5);
    equal(wishes.map((wish) => wish.seed), [1, 2, 3, 4, 5]);
  },
  "a sweep leans more and more": () => {
    const { wishes } = parse({ kind: "tilts", frames: "3" });
    equal(wishes.map((wish) => wish.tilt_deg), [0, 35, 70]);
  },
  "speed goes where the picture's top points": () => {
    const [{ velocity_mm_s: [x, y, z] }] = parse({ speed_mm_s: "100", heading_deg: "90" }).wishes;
    near(x, 100, 1e-3);
    near(y, 0, 1e-3);
    equal(z, 0);
  },
  "what cannot be is named, where it is asked for": () => {
    contains(parse({ height_mm: "0" }).errors.height_mm, "Height: from 1");
    contains(parse({ tilt_deg: "95" }).errors.tilt_deg, "to 89");
    contains(parse({ kind: "descent", frames: "3.5" }).errors.frames, "whole");
    equal(parse({ to_mm: "-4", frames: "x" }).errors, {});
    equal([isAsked("to_mm", "one"), isAsked("to_mm", "descent"), isAsked("seed", "one")], [false, true, true]);
  },
  "the address holds what differs, and brings it back": () => {
    const texts = { ...DEFAULT_FRAME, kind: "descent", look: "shadow" };
    equal(framesToQuery(texts), { kind: "descent", look: "shadow" });
    equal(framesFromQuery(new URLSearchParams(framesToQuery(texts))), texts);
  },
  "Diagnose gets all that it takes to take the same pictures": () => {
    const texts = { ...DEFAULT_FRAME, height_mm: "500" };
    const link = diagnoseLink({ pad: "p1", camera: "c1", method: "dense" }, texts);
    const query = new URLSearchParams(link.split("?")[1]);
    equal([query.get("pad"), query.get("camera"), query.get("method")], ["p1", "c1", "dense"]);
    equal(framesFromQuery(new URLSearchParams(query.get("simulate"))), texts);
  },
  "names and words": () => {
    const [wish] = parse({}).wishes;
    equal(frameName(wish), "simulated 1000 mm, 10 deg, clear.jpg");
    equal(frameInWords(wish), "1000 mm, 10°");
    const truth = { position_mm: [1, -2.04, 300], heading_deg: 12.34, tilt_deg: 5 };
    equal(truthFacts(truth)[1], ["Y", "−2.0 mm"]);
  },
};
