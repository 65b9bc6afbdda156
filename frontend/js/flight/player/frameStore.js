/**
 * The frames about the one that is looked at, held ready: pictures, results and outlines come in
 * groups, ahead and behind, so that a step takes no request.
 *
 * @typedef {import("./proxyLogic.js").Group} Group
 * @typedef {import("./proxyLogic.js").Proxy} Proxy
 * @typedef {import("./proxyLogic.js").Whole} Whole
 * @typedef {import("../../server/flightsApi.js").FrameRecord} FrameRecord
 * @typedef {import("../../server/flightsApi.js").OutlineLine} OutlineLine
 *
 * @typedef {object} Held  what is known of a frame
 * @property {FrameRecord | null | undefined} record  undefined: not fetched; null: not read
 * @property {OutlineLine[]} lines
 * @property {Proxy | null | undefined} proxy
 * @property {ImageBitmap | null} bitmap
 */

import { getOutlines, getProxies, listFrames } from "../../server/flightsApi.js";
import { isAbort } from "../../server/request.js";
import { firstOf, framesAround, GROUP_FRAMES, groupFromBytes, groupOf, groupsFor } from "./proxyLogic.js";

/** Held in memory: about 1 MB a group of pictures, 1 MB a decoded one. */
const GROUPS = 24;
const BITMAPS = 48;
/** Between looks at how far the making of pictures is. */
const AGAIN_MS = 300;

/**
 * @param {string} id  of the flight
 * @param {{onChange: (group: number) => void, onMaking: (making: {done: number, total: number} | null) => void,
 *   onFault: (error: unknown) => void}} events
 */
export function makeFrameStore(id, { onChange, onMaking, onFault }) {
  /** @type {Map<number, Group>} */
  const pictures = new Map();
  /** @type {Map<number, {records: Map<number, FrameRecord>, lines: Map<number, OutlineLine[]>, final: boolean}>} */
  const results = new Map();
  /** @type {Map<number, ImageBitmap>} */
  const bitmaps = new Map();
  /** @type {Map<string, Promise<void>>} */
  const coming = new Map();
  /** @type {Whole | null} */
  let whole = null;
  let isFinal = false;
  let wanted = -1;
  /** @type {1 | -1} */
  let way = 1;
  let timer = 0;
  let isFailing = false;

  /** One question of a kind and group at a time. @param {string} key @param {() => Promise<void>} ask */
  function once(key, ask) {
    if (coming.has(key)) return;
    const answer = ask().catch((error) => {
      if (isAbort(error)) return;
      isFailing = true;
      onFault(error);
    }).finally(() => coming.delete(key));
    coming.set(key, answer);
  }

  /** @param {number} group */
  async function fetchPictures(group) {
    const found = groupFromBytes(await getProxies(id, group));
    keep(pictures, group, found, GROUPS);
    if (whole && group === groupOf(wanted, whole)) onMaking(found.complete ? null : found.making);
    if (!found.complete && found.making) askAgain();
    decodeAround();
    onChange(group);
  }

  /** @param {number} group */
  async function fetchResults(group) {
    if (!whole) return;
    const first = firstOf(group, whole);
    const final = isFinal;
    const limit = GROUP_FRAMES;
    const after = first - 1;
    const before = first + GROUP_FRAMES * whole.stride;
    const [page, outlines] = await Promise.all([
      listFrames(id, { after, before, limit }),
      getOutlines(id, { first_frame: first, limit }),
    ]);
    const records = new Map(page.items.map((record) => [record.frame, record]));
    const lines = new Map(outlines.items.map((each) => [each.frame, each.lines]));
    keep(results, group, { records, lines, final }, 4 * GROUPS);
    onChange(group);
  }

  function askAgain() {
    window.clearTimeout(timer);
    timer = window.setTimeout(fetchAround, AGAIN_MS);
  }

  function fetchAround() {
    if (!whole || wanted < 0 || isFailing) return;
    const groups = groupsFor(wanted, way, whole);
    for (const group of groups) {
      const result = results.get(group);
      if (!result || (isFinal && !result.final)) once(`results ${group}`, () => fetchResults(group));
      // What lies ahead may wait until the frame itself is there.
      const isFirst = group === groups[0];
      const isMaking = pictures.get(groups[0])?.complete === false;
      if (!pictures.get(group)?.complete && (isFirst || !isMaking)) once(`pictures ${group}`, () => fetchPictures(group));
    }
  }

  /** @param {number} frame @returns {Proxy | undefined} */
  const proxyOf = (frame) => (whole ? pictures.get(groupOf(frame, whole))?.proxies.get(frame) : undefined);

  function decodeAround() {
    if (!whole) return;
    for (const frame of framesAround(wanted, way, whole)) {
      const jpeg = proxyOf(frame)?.jpeg;
      if (bitmaps.has(frame) || !jpeg) continue;
      once(`bitmap ${frame}`, async () => {
        keep(bitmaps, frame, await createImageBitmap(jpeg), BITMAPS, (bitmap) => bitmap.close());
        if (whole && frame === wanted) onChange(groupOf(frame, whole));
      });
    }
  }

  return {
    /**
     * What the flight is by now.
     * @param {Whole} next
     * @param {boolean} isDone
     */
    follow(next, isDone) {
      whole = next;
      // Frames that were read since are asked for again.
      if (!isFinal) {
        for (const [group, { records }] of results) if (isDone || records.size < GROUP_FRAMES) results.delete(group);
      }
      isFinal = isDone;
      fetchAround();
    },
    /** The frame that is looked at. @param {number} frame */
    want(frame) {
      if (frame !== wanted) way = frame < wanted ? -1 : 1;
      wanted = frame;
      fetchAround();
      decodeAround();
    },
    /** Ask once more for what failed. */
    retry() {
      isFailing = false;
      fetchAround();
    },
    /** @param {number} frame @returns {Held} */
    get(frame) {
      const group = whole ? groupOf(frame, whole) : -1;
      const found = results.get(group);
      return {
        record: found ? (found.records.get(frame) ?? null) : undefined,
        lines: found?.lines.get(frame) ?? [],
        proxy: proxyOf(frame),
        bitmap: bitmaps.get(frame) ?? null,
      };
    },
    /** @param {number} frame @returns {number | null | undefined} s; undefined where its picture is not there */
    timeOf(frame) {
      const proxy = proxyOf(frame);
      if (!proxy) return undefined;
      return proxy.time_s;
    },
  };
}

/**
 * Keep a value, and let go of those that were kept for longest.
 * @template T
 * @param {Map<number, T>} map
 * @param {number} key
 * @param {T} value
 * @param {number} most
 * @param {(value: T) => void} [letGo]
 */
function keep(map, key, value, most, letGo) {
  map.delete(key);
  map.set(key, value);
  for (const [oldest, old] of map) {
    if (map.size <= most) return;
    map.delete(oldest);
    letGo?.(old);
  }
}
