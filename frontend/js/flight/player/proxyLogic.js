/**
 * The small pictures of a flight's frames: which belong together, what a file of them holds, which
 * are fetched next, and which frame stands at a moment of play.
 *
 * @typedef {{first: number, last: number, stride: number}} Whole
 *
 * @typedef {object} Proxy
 * @property {number} frame
 * @property {number | null} time_s
 * @property {number} width  of the whole frame, pixels; 0 where it was lost
 * @property {number} height
 * @property {number} scale  pixels of the frame per pixel of the picture
 * @property {Blob | null} jpeg  null where the frame was lost
 *
 * @typedef {object} Group
 * @property {boolean} complete
 * @property {{done: number, total: number} | null} making  how far it is; null: nothing is being made
 * @property {Map<number, Proxy>} proxies  by frame
 */

/** Frames of a group, as the server has it. */
export const GROUP_FRAMES = 16;
const LENGTH_BYTES = 4;
/** Seconds a frame where it has no time: stills. */
const STILL_S = 0.2;
/** Groups that are held ahead in the direction of travel, and behind. */
const AHEAD = 2;

/** @param {number} frame @param {Whole} whole @returns {number} */
export const groupOf = (frame, { first, stride }) =>
  Math.floor((frame - (first % stride)) / stride / GROUP_FRAMES);

/** @param {number} group @param {Whole} whole @returns {number} its first frame */
export const firstOf = (group, { first, stride }) => (first % stride) + group * GROUP_FRAMES * stride;

/**
 * What a file of proxies holds.
 * @param {ArrayBuffer} data
 * @returns {Group}
 */
export function groupFromBytes(data) {
  const length = new DataView(data).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, LENGTH_BYTES, length)));
  const proxies = new Map();
  let start = LENGTH_BYTES + length;
  for (const { bytes, ...proxy } of head.frames) {
    const jpeg = bytes ? new Blob([new Uint8Array(data, start, bytes)], { type: "image/jpeg" }) : null;
    proxies.set(proxy.frame, { ...proxy, jpeg });
    start += bytes;
  }
  return { complete: head.complete, making: head.making, proxies };
}

/**
 * Groups that should be there for a frame: its own, those that the next steps and jumps of ten lead
 * to, and more of them the way that the user goes.
 * @param {number} frame
 * @param {1 | -1} way
 * @param {Whole} whole
 * @returns {number[]} the most urgent first
 */
export function groupsFor(frame, way, whole) {
  const [own, first, last] = [frame, whole.first, whole.last].map((each) => groupOf(each, whole));
  const order = [own, own + way, own - way];
  for (let far = 2; far <= AHEAD; far += 1) order.push(own + far * way);
  return order.filter((group) => group >= first && group <= last);
}

/**
 * Frames whose pictures should be decoded, the most urgent first.
 * @param {number} frame
 * @param {1 | -1} way
 * @param {Whole} whole
 * @returns {number[]}
 */
export function framesAround(frame, way, { first, last, stride }) {
  const steps = [0, 1, -1, 10, -10, 2, 3, -2, 4, 5, 6, 20];
  return steps.map((step) => frame + step * way * stride).filter((each) => each >= first && each <= last);
}

/**
 * The frame that stands so long after play began.
 * @param {{frame: number, elapsed_s: number, loop: {from: number, to: number} | null}} at  `frame`: where play began
 * @param {Whole} whole
 * @param {(frame: number) => number | null | undefined} timeOf  undefined where it is not known yet
 * @returns {{frame: number, ended: boolean, wrapped: boolean}}  the last one that is known to stand by then
 */
export function frameAfter({ frame, elapsed_s: elapsed, loop }, whole, timeOf) {
  const last = loop ? loop.to : whole.last;
  const started = timeOf(frame);
  let now = frame;
  for (let step = 1; now < last; step += 1) {
    const next = now + whole.stride;
    const time = timeOf(next);
    if (time === undefined) break;
    const due = time === null || started === null || started === undefined ? step * STILL_S : time - started;
    if (due > elapsed) break;
    now = next;
  }
  if (now < last) return { frame: now, ended: false, wrapped: false };
  const lastDue = dueOf(frame, last, whole, timeOf);
  // The last frame is shown as long as the one before it.
  if (elapsed < lastDue) return { frame: now, ended: false, wrapped: false };
  return loop ? { frame: loop.from, ended: false, wrapped: true } : { frame: now, ended: true, wrapped: false };
}

/** @param {number} frame @param {number} last @param {Whole} whole @param {(frame: number) => number | null | undefined} timeOf */
function dueOf(frame, last, { stride }, timeOf) {
  const [started, end, before] = [frame, last, last - stride].map(timeOf);
  if (started === null || started === undefined || end === null || end === undefined) {
    return ((last - frame) / stride + 1) * STILL_S;
  }
  const width = before === null || before === undefined ? STILL_S : end - before;
  return end - started + width;
}

/**
 * A looped range with an end put at a frame.
 * @param {{from: number, to: number} | null} loop
 * @param {"from" | "to"} end
 * @param {number} frame
 * @param {Whole} whole
 * @returns {{from: number, to: number} | null}  null: the whole flight
 */
export function loopWith(loop, end, frame, { first, last }) {
  const next = { from: first, to: last, ...loop, [end]: frame };
  if (next.from > next.to) Object.assign(next, end === "from" ? { to: last } : { from: first });
  return next.from === first && next.to === last ? null : next;
}

/** @param {{from: number, to: number} | null} loop @returns {string | null} for the address */
export const loopToText = (loop) => (loop ? `${loop.from}-${loop.to}` : null);

/** @param {string | null} text */
export function loopFromText(text) {
  const found = /^(\d{1,9})-(\d{1,9})$/.exec(text ?? "");
  return found && Number(found[1]) < Number(found[2]) ? { from: Number(found[1]), to: Number(found[2]) } : null;
}
