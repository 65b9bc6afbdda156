import { equal } from "./check.js";
import { makePlayer } from "/static/js/flight/player/player.js";
import {
  firstOf, frameAfter, framesAround, groupFromBytes, groupOf, groupsFor, loopFromText, loopToText, loopWith,
} from "/static/js/flight/player/proxyLogic.js";

const WHOLE = { first: 0, last: 99, stride: 1 };

/** @param {object} head @param {number[]} bytes */
function file(head, bytes) {
  const text = new TextEncoder().encode(JSON.stringify(head));
  const data = new Uint8Array(4 + text.length + bytes.length);
  new DataView(data.buffer).setUint32(0, text.length, true);
  data.set(text, 4);
  data.set(bytes, 4 + text.length);
  return data.buffer;
}

export const tests = {
  "groups of sixteen, also with a stride": () => {
    equal([0, 15, 16, 99].map((frame) => groupOf(frame, WHOLE)), [0, 0, 1, 6]);
    const strided = { first: 7, last: 97, stride: 3 };
    for (let frame = 7; frame <= 97; frame += 3) {
      const first = firstOf(groupOf(frame, strided), strided);
      equal([(frame - first) % 3, frame >= first, frame < first + 48], [0, true, true]);
    }
  },
  "a file's pictures and what is lost": async () => {
    const about = { time_s: 0.5, width: 60, height: 40, scale: 1 };
    const frames = [{ frame: 4, ...about, bytes: 3 }, { frame: 5, ...about, width: 0, bytes: 0 }];
    const group = groupFromBytes(file({ frames, complete: true, making: null }, [1, 2, 3]));
    equal(group.complete, true);
    const jpeg = group.proxies.get(4)?.jpeg;
    equal(new Uint8Array(await /** @type {Blob} */ (jpeg).arrayBuffer()), [1, 2, 3]);
    equal([group.proxies.get(5)?.jpeg, group.proxies.get(5)?.time_s, group.proxies.get(6)], [null, 0.5, undefined]);
  },
  "groups ahead come first, none beyond the flight": () => {
    equal(groupsFor(50, 1, WHOLE), [3, 4, 2, 5]);
    equal(groupsFor(50, -1, WHOLE), [3, 2, 4, 1]);
    equal(groupsFor(0, -1, WHOLE), [0, 1]);
  },
  "every step and jump of ten is decoded ahead": () => {
    for (const way of /** @type {(1 | -1)[]} */ ([1, -1])) {
      const frames = framesAround(50, way, WHOLE);
      equal([49, 50, 51, 40, 60].every((frame) => frames.includes(frame)), true);
      equal(frames[0], 50);
    }
    equal(framesAround(0, 1, WHOLE).every((frame) => frame >= 0), true);
  },
  "play shows the frame whose time it is": () => {
    const timeOf = (/** @type {number} */ frame) => frame / 25;
    const at = (/** @type {number} */ elapsed) => frameAfter({ frame: 10, elapsed_s: elapsed, loop: null }, WHOLE, timeOf);
    equal(at(0).frame, 10);
    equal(at(0.0401).frame, 11);
    equal(at(1.001).frame, 35);
    equal(at(89.5 / 25), { frame: 99, ended: false, wrapped: false });
    equal(at(90.1 / 25).ended, true);
  },
  "a varying rate is kept": () => {
    const times = [0, 0.1, 0.5, 0.6];
    const whole = { first: 0, last: 3, stride: 1 };
    const at = (/** @type {number} */ elapsed) => frameAfter({ frame: 0, elapsed_s: elapsed, loop: null }, whole, (frame) => times[frame]).frame;
    equal([0.05, 0.1, 0.49, 0.5, 0.61].map(at), [0, 1, 1, 2, 3]);
  },
  "play stops where nothing is known yet": () => {
    const timeOf = (/** @type {number} */ frame) => (frame < 13 ? frame / 25 : undefined);
    equal(frameAfter({ frame: 10, elapsed_s: 5, loop: null }, WHOLE, timeOf).frame, 12);
  },
  "stills have a pace of their own": () => {
    equal(frameAfter({ frame: 0, elapsed_s: 0.45, loop: null }, WHOLE, () => null).frame, 2);
  },
  "a loop begins again": () => {
    const timeOf = (/** @type {number} */ frame) => frame / 10;
    const loop = { from: 5, to: 8 };
    equal(frameAfter({ frame: 5, elapsed_s: 0.35, loop }, WHOLE, timeOf), { frame: 8, ended: false, wrapped: false });
    equal(frameAfter({ frame: 5, elapsed_s: 0.41, loop }, WHOLE, timeOf), { frame: 5, ended: false, wrapped: true });
  },
  "ends of a loop": () => {
    equal(loopWith(null, "from", 20, WHOLE), { from: 20, to: 99 });
    equal(loopWith({ from: 20, to: 99 }, "to", 30, WHOLE), { from: 20, to: 30 });
    equal(loopWith({ from: 20, to: 30 }, "from", 40, WHOLE), { from: 40, to: 99 });
    equal(loopWith({ from: 20, to: 30 }, "to", 10, WHOLE), { from: 0, to: 10 });
    equal(loopWith({ from: 0, to: 30 }, "to", 99, WHOLE), null);
    equal(loopFromText(loopToText({ from: 3, to: 9 })), { from: 3, to: 9 });
    equal([loopFromText("9-3"), loopFromText(null), loopFromText("a-b")], [null, null, null]);
  },
  "play ends at the last frame, though its picture never comes": async () => {
    let frame = 0;
    /** @type {number[]} */
    const shown = [];
    await new Promise((resolve) => {
      const player = makePlayer({
        whole: () => ({ first: 0, last: 3, stride: 1 }),
        frame: () => frame,
        loop: () => null,
        timeOf: (at) => (at <= 3 ? at / 30 : null),
        isReady: (at) => at < 3,
        onFrame: (at) => shown.push((frame = at)),
        onWant: () => undefined,
        onEnd: () => {
          player.update(false);
          resolve(undefined);
        },
      });
      player.update(true);
    });
    equal(shown.at(-1), 3);
  },
};
