/**
 * Has the server simulate pictures and maps piece by piece, so that both fill as they are made and
 * can be stopped.
 *
 * @typedef {import("../shared/frameLogic.js").FrameWish} FrameWish
 * @typedef {import("./filmStrip.js").Shot} Shot
 * @typedef {import("../server/planApi.js").SuccessMap} SuccessMap
 */

import { frameInWords, frameName, truthFacts } from "../shared/frameLogic.js";
import * as planApi from "../server/planApi.js";
import { withRow } from "./planLogic.js";

/**
 * A simulated picture as a file.
 * @param {import("../server/planApi.js").SimulatedFrame} frame
 * @param {string} name
 * @returns {File}
 */
export function fileOfFrame({ picture }, name) {
  const bytes = Uint8Array.from(atob(picture.base64), (letter) => letter.charCodeAt(0));
  return new File([bytes], name, { type: picture.media_type });
}

/**
 * @param {FrameWish[]} wishes
 * @param {{pad: string, camera: string}} scene
 * @param {AbortSignal} [signal]
 * @returns {AsyncGenerator<{file: File, truth: planApi.SimulatedFrame["truth"]}>}
 */
export async function* simulateFrames(wishes, scene, signal) {
  for (const wish of wishes) {
    const frame = await planApi.simulateFrame({ ...scene, ...wish }, signal);
    yield { file: fileOfFrame(frame, frameName(wish)), truth: frame.truth };
  }
}

export function makeSimulator() {
  let running = new AbortController();

  function begin() {
    running.abort();
    running = new AbortController();
    return running.signal;
  }

  return {
    stop() {
      running.abort();
    },
    /**
     * @param {FrameWish[]} wishes
     * @param {{pad: string, camera: string}} scene
     * @param {(shots: Shot[], progress: string) => void} onShots
     */
    async takeFrames(wishes, scene, onShots) {
      const signal = begin();
      /** @type {Shot[]} */
      let shots = wishes.map((wish) => ({ words: frameInWords(wish), url: null, truth: [] }));
      let done = 0;
      const progress = () => (done < wishes.length ? `Picture ${done + 1} of ${wishes.length} …` : "");
      onShots(shots, progress());
      for await (const { file, truth } of simulateFrames(wishes, scene, signal)) {
        if (signal.aborted) return;
        const taken = { ...shots[done], url: URL.createObjectURL(file), truth: truthFacts(truth) };
        shots = shots.with(done, taken);
        done += 1;
        onShots(shots, progress());
      }
    },
    /**
     * @param {{axis: string, heights_mm: number[], values: number[], trials: number}} plan
     * @param {{pad: string, camera: string, method: string}} reading
     * @param {(map: SuccessMap | null, progress: string) => void} onMap
     */
    async makeMap({ heights_mm: heights, ...plan }, { pad, camera, method }, onMap) {
      const signal = begin();
      /** @type {SuccessMap | null} */
      let map = null;
      for (const [row, height] of heights.entries()) {
        onMap(map, `Height ${row + 1} of ${heights.length} …`);
        const wish = { camera, method, ...plan, heights_mm: [height], seed: row + 1 };
        map = withRow(map, await planApi.simulateCoverage(pad, wish, signal));
        if (signal.aborted) return;
      }
      onMap(map, "");
    },
  };
}
