import { cameraFile, NOMINAL, nominalOf } from "/static/js/live/nominalCameraLogic.js";
import { equal } from "./check.js";

const focal = (text) => Number(/data: \[([\d.]+)/.exec(text)[1]);

export const tests = {
  "the longer side is as wide as is said": () => {
    const file = cameraFile({ name: "x", wide_deg: 90 }, 1280, 720);
    equal(Math.round(focal(file)), 640);
    equal(Math.round(focal(cameraFile({ name: "x", wide_deg: 90 }, 720, 1280))), 640);
  },
  "it is marked as nominal, and has the picture's size": () => {
    const file = cameraFile(NOMINAL[0], 1280, 720);
    equal(["nominal: true", "image_width: 1280", "image_height: 720"].every((line) => file.includes(`${line}\n`)), true);
  },
  "each has an id of its own": () => {
    equal(new Set(NOMINAL.map(({ id }) => id)).size, NOMINAL.length);
    equal(NOMINAL.every(({ id }) => nominalOf(id)?.id === id), true);
  },
  "others are none": () => equal(nominalOf("preset-webcam-c270"), undefined),
};
