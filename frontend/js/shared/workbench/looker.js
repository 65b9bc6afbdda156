/**
 * Fetches what the views of a workbench show, the newest wish first.
 *
 * While a slider moves only the view that is looked at is fetched, quickly; once it rests, all
 * views that are not up to date, a few at a time. One question is under way at a time, so that the
 * next one is always the newest, and what became old meanwhile is never asked.
 *
 * @typedef {import("../../server/tuningApi.js").Reading} Reading
 * @typedef {import("../../server/tuningApi.js").Look} Look
 * @typedef {import("../../server/tuningApi.js").ViewWish} ViewWish
 * @typedef {import("../../server/tuningApi.js").Marks} Marks
 *
 * @typedef {object} Picture
 * @property {ImageBitmap | null} bitmap  null where there is nothing to see
 * @property {import("../../server/tuningApi.js").Part | null} part
 * @property {boolean} exact
 * @property {Marks | null} marks
 *
 * @typedef {object} LookerOptions
 * @property {() => Reading | null} reading
 * @property {() => ViewWish[]} views  all that are to be seen, the one that is looked at first
 * @property {(look: Look, pictures: Map<string, Picture>, isWhole: boolean) => void} onLook
 * @property {(error: unknown) => void} onFault
 * @property {(isBusy: boolean) => void} onBusy
 */

import { isAbort } from "../../server/request.js";
import { lookAt } from "../../server/tuningApi.js";
import { keyOf } from "./workbenchLogic.js";

// A slider that stands still for so long rests.
const REST_MS = 200;
const AT_ONCE = 5;
// Where a slider may be moved again, its next step waits for no more than one view.
const AT_ONCE_TUNED = 1;

/** @param {LookerOptions} options */
export function makeLooker({ reading, views, onLook, onFault, onBusy }) {
  let version = 0;
  let shown = -1;
  let isMoving = false;
  let atOnce = AT_ONCE;
  let timer = 0;
  let isFailed = false;
  /** @type {AbortController | null} */
  let running = null;
  /** What was fetched for each view. @type {Map<string, string>} */
  const fetched = new Map();

  /** @param {ViewWish} wish */
  const wishKey = ({ stage, channel, scale, part }) =>
    `${version} ${keyOf({ stage, channel })} ${scale.toPrecision(3)} ${part?.join(",") ?? ""}`;
  const isOld = (/** @type {ViewWish} */ wish) => fetched.get(keyOf(wish)) !== wishKey(wish);

  /** @returns {{views: ViewWish[], isQuick: boolean} | null} */
  function next() {
    if (isFailed || !reading()) return null;
    const [first, ...rest] = views();
    if (isMoving && shown === version) return null;
    if (isMoving && first) return { views: [{ ...first, quick: true }], isQuick: true };
    const old = [first, ...rest].filter(Boolean).filter(isOld).slice(0, atOnce);
    return old.length || shown !== version ? { views: old, isQuick: false } : null;
  }

  async function work() {
    if (running) return;
    for (let job = next(); job; job = next()) {
      running = new AbortController();
      const asked = version;
      const keys = job.isQuick ? [] : job.views.map((wish) => [keyOf(wish), wishKey(wish)]);
      onBusy(true);
      try {
        const look = await lookAt(/** @type {Reading} */ (reading()), job.views, running.signal);
        const pictures = await decoded(look);
        if (running.signal.aborted) continue;
        shown = asked;
        for (const [key, value] of keys) fetched.set(key, value);
        onLook(look, pictures, !job.isQuick);
      } catch (error) {
        if (isAbort(error)) continue;
        isFailed = asked === version;
        onFault(error);
      }
    }
    running = null;
    onBusy(false);
  }

  return {
    /** A parameter changed. @param {boolean} isDragged */
    changed(isDragged) {
      version += 1;
      isFailed = false;
      isMoving = isDragged;
      if (isDragged) atOnce = AT_ONCE_TUNED;
      window.clearTimeout(timer);
      if (isDragged) {
        timer = window.setTimeout(() => {
          isMoving = false;
          void work();
        }, REST_MS);
      }
      void work();
    },
    /** Views moved, or others are looked at. */
    moved() {
      window.clearTimeout(timer);
      timer = window.setTimeout(() => {
        isMoving = false;
        void work();
      }, REST_MS);
    },
    /** Another frame. */
    reset() {
      running?.abort();
      fetched.clear();
      version += 1;
      isFailed = false;
      isMoving = false;
      atOnce = AT_ONCE;
      void work();
    },
    /** Ask again after a fault. */
    again() {
      isFailed = false;
      void work();
    },
  };
}

/** @param {Look} look @returns {Promise<Map<string, Picture>>} */
async function decoded({ pictures }) {
  const found = await Promise.all(pictures.map(async ({ base64, media_type: type, part, exact, marks, ...view }) => {
    const bitmap = base64 ? await createImageBitmap(new Blob([bytesOf(base64)], { type: type ?? "" })) : null;
    return /** @type {[string, Picture]} */ ([keyOf(view), { bitmap, part, exact, marks }]);
  }));
  return new Map(found);
}

/** @param {string} base64 */
const bytesOf = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
