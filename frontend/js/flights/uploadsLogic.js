/**
 * The files of a new flight and how far each is sent.
 *
 * @typedef {object} Item
 * @property {string} key  by which the file is known again
 * @property {string} folder  in which it lay; empty for a single file
 * @property {string} name
 * @property {number} size  bytes
 * @property {File | null} file  null after a reload, until it is chosen again
 * @property {string | null} url  of the upload
 * @property {string | null} id  of the upload, once it is complete
 * @property {number} offset  bytes that the server has
 * @property {"waiting" | "sending" | "done" | "refused"} status
 * @property {string} message  why it is refused, or why nothing moves
 * @property {string | null} [kind]  of a zip, once it is complete
 *
 * @typedef {object} Row  one line of the list: a file, or all stills of a folder
 * @property {string} key
 * @property {string} title
 * @property {string} note
 * @property {number} share  0 … 1
 * @property {"waiting" | "sending" | "done" | "refused" | "absent"} status
 * @property {boolean} troubled  it waits for the server or the connection
 * @property {string[]} keys  of its items
 */

import { bytes, number } from "../shared/formatLogic.js";
import { isPicture, mayBeRecording } from "../shared/queueLogic.js";
import { fingerprint } from "../server/uploads/tusLogic.js";

/** A folder of more stills than this is one line. */
const MANY = 6;

const collator = new Intl.Collator("en", { numeric: true });

/** Frames follow the names, 2 before 10. @param {Item} a @param {Item} b */
const byName = (a, b) => collator.compare(a.folder, b.folder) || collator.compare(a.name, b.name);

/**
 * Add chosen files; one that was begun before a reload goes on.
 * @param {Item[]} items
 * @param {{file: File, folder: string}[]} chosen
 * @returns {Item[]}
 */
export function withFiles(items, chosen) {
  const known = new Map(items.map((item) => [item.key, item]));
  for (const { file, folder } of chosen) {
    const key = fingerprint(file, folder);
    const before = known.get(key);
    if (before) {
      const status = before.status === "done" ? "done" : "waiting";
      if (!before.file) known.set(key, { ...before, file, status, message: "" });
      continue;
    }
    const { name, size } = file;
    const fault = size ? "" : "The file is empty.";
    const status = fault ? "refused" : "waiting";
    known.set(key, {
      key, folder, name, size, file, url: null, id: null, offset: 0, status, message: fault,
    });
  }
  return [...known.values()].sort(byName);
}

/**
 * True where a topic may have to be chosen.
 * @param {Pick<Item, "name">[]} items
 */
export const hasTopics = (items) => items.some(({ name }) => mayBeRecording(name));

/**
 * True where the camera may come with the files.
 * @param {Pick<Item, "name">[]} items
 */
export const mayBringCamera = (items) => items.length > 0 && items.every(({ name }) => mayBeRecording(name));

/**
 * True where the files are a live session's recording, which brings its pad, its camera and its poses.
 * @param {Pick<Item, "name" | "kind" | "status">[]} items
 */
export const isLive = (items) =>
  items.some(({ name, kind, status }) => status !== "refused" && (kind === "live" || /^session\.json$/i.test(name)));

/** Of more pictures than this a flight is meant. */
const FEW = 3;

/**
 * True where a few pictures alone were chosen, which Diagnose shows stage by stage.
 * @param {Pick<Item, "name">[]} items
 * @returns {boolean}
 */
export const fewPictures = (items) =>
  items.length > 0 && items.length <= FEW && items.every(({ name }) => isPicture(name));

/**
 * @param {Item[]} items
 * @param {string} key
 * @param {Partial<Item>} change
 * @returns {Item[]}
 */
export const withItem = (items, key, change) =>
  items.map((item) => (item.key === key ? { ...item, ...change } : item));

/**
 * The files to send next.
 * @param {Item[]} items
 * @param {number} slots  that may be sent at once
 * @returns {Item[]}
 */
export function nextToSend(items, slots) {
  const busy = items.filter((item) => item.status === "sending").length;
  const waiting = items.filter((item) => item.status === "waiting" && item.file);
  return waiting.slice(0, Math.max(0, slots - busy));
}

/**
 * The lines of the list.
 * @param {Item[]} items
 * @returns {Row[]}
 */
export function rowsOf(items) {
  /** @type {Map<string, Item[]>} */
  const folders = new Map();
  for (const item of items) folders.set(item.folder, [...(folders.get(item.folder) ?? []), item]);
  return [...folders].flatMap(([folder, members]) =>
    folder && members.length > MANY ? [folderRow(folder, members)] : members.map(fileRow),
  );
}

/** @param {Item} item @returns {Row} */
function fileRow(item) {
  const { key, name, size, offset, message } = item;
  const status = item.status === "waiting" && !item.file ? "absent" : item.status;
  const notes = {
    waiting: `${bytes(size)}, waiting`,
    sending: message ? `${message} Trying again …` : `${bytes(offset)} of ${bytes(size)}`,
    done: `${bytes(size)}, sent`,
    refused: message,
    absent: `${bytes(offset)} of ${bytes(size)} are sent. Choose the file again to go on.`,
  };
  const troubled = status === "absent" || (status === "sending" && Boolean(message));
  const share = size ? offset / size : 0;
  return { key, title: name, note: notes[status], share, status, troubled, keys: [key] };
}

/** @param {string} folder @param {Item[]} items @returns {Row} */
function folderRow(folder, items) {
  const rows = items.map(fileRow);
  const count = (/** @type {Row["status"]} */ status) =>
    rows.filter((row) => row.status === status).length;
  const [done, refused, absent] = [count("done"), count("refused"), count("absent")];
  const share = done / items.length;
  const parts = [`${number(done)} of ${number(items.length)} stills sent`];
  if (refused) parts.push(`${number(refused)} refused: ${rows.find((row) => row.status === "refused")?.note}`);
  if (absent) parts.push("choose the folder again to go on");
  const trouble = items.find((item) => item.status === "sending" && item.message);
  if (trouble) parts.push(`${trouble.message} Trying again …`);
  /** @type {Row["status"]} */
  const status = refused ? "refused" : absent ? "absent" : share === 1 ? "done" : "sending";
  const keys = items.map((item) => item.key);
  const troubled = Boolean(absent || trouble);
  return { key: `folder ${folder}`, title: folder, note: parts.join(", "), share, status, troubled, keys };
}

/**
 * Everything in one figure.
 * @param {Item[]} items
 * @returns {{sent: number, size: number, done: number, total: number}}
 */
export function totals(items) {
  const kept = items.filter((item) => item.status !== "refused");
  const sum = (/** @type {(item: Item) => number} */ value) =>
    kept.reduce((all, item) => all + value(item), 0);
  return {
    sent: sum((item) => item.offset),
    size: sum((item) => item.size),
    done: kept.filter((item) => item.status === "done").length,
    total: kept.length,
  };
}

/**
 * Uploads of a new flight, in the order of its frames; null while some are not there.
 * @param {Item[]} items
 * @returns {string[] | null}
 */
export function readyIds(items) {
  const kept = items.filter((item) => item.status !== "refused");
  const ids = kept.flatMap((item) => (item.status === "done" && item.id ? [item.id] : []));
  return kept.length && ids.length === kept.length ? ids : null;
}

/** What outlives a reload. @param {Item[]} items @returns {string} */
export const toStorage = (items) =>
  JSON.stringify(
    items
      .filter((item) => item.url && item.status !== "refused")
      .map(({ key, folder, name, size, url, id, offset, kind = null }) => ({ key, folder, name, size, url, id, offset, kind })),
  );

/**
 * @param {string | null} text
 * @returns {Item[]}
 */
export function fromStorage(text) {
  let stored;
  try {
    stored = JSON.parse(text ?? "[]");
  } catch {
    return [];
  }
  if (!Array.isArray(stored)) return [];
  return stored
    .filter((item) => typeof item?.key === "string" && typeof item.url === "string")
    .map((item) => ({ ...item, file: null, message: "", status: item.id ? "done" : "waiting" }));
}

/**
 * Items of several lists, each once.
 * @param {string[]} texts
 * @returns {Item[]}
 */
export function fromLists(texts) {
  const items = texts.flatMap(fromStorage).reverse();
  return [...new Map(items.map((item) => [item.key, item])).values()].sort(byName);
}
