/**
 * Has the server simulate pictures and maps piece by piece, so that both fill as they are made and
 * can be stopped.
 *
 * @typedef {import("../shared/frameLogic.js").FrameWish} FrameWish
 * @typedef {import("./filmStrip.js").Shot} Shot
 * @typedef {import("../server/planApi.js").SuccessMap} SuccessMap
 */

import { frameInWords, truthFacts } from "../shared/frameLogic.js";
import * as planApi from "../server/planApi.js";
import { simulateFrames } from "../shared/simulatedFrames.js";
import { withRow } from "./planLogic.js";

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
     * @param {{pad: string, camera: string}} reading
     * @param {(shots: Shot[], progress: string) => void} onShots
     */
    async takeFrames(wishes, reading, onShots) {
      const signal = begin();
      /** @type {Shot[]} */
      let shots = wishes.map((wish) => ({ words: frameInWords(wish), url: null, truth: [] }));
      let done = 0;
      const progress = () => (done < wishes.length ? `Picture ${done + 1} of ${wishes.length} …` : "");
      onShots(shots, progress());
      for await (const { file, truth } of simulateFrames(wishes, reading, signal)) {
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
