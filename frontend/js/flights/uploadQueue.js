/**
 * Sends the files of a new flight, some at a time, and remembers them over a reload.
 *
 * @typedef {import("./uploadsLogic.js").Item} Item
 */

import { ApiError, messageOf } from "../server/request.js";
import { getUpload } from "../server/flightsApi.js";
import { removeUpload, sendFile } from "../server/uploads/tusUpload.js";
import { claimMemory } from "./uploadMemory.js";
import * as uploads from "./uploadsLogic.js";

const SLOTS = 2;

/**
 * @param {{onChange: (items: Item[]) => void}} events
 */
export function makeUploadQueue({ onChange }) {
  /** @type {Map<string, AbortController>} */
  const running = new Map();
  /** @type {Item[]} */
  let items = [];
  /** @type {import("./uploadMemory.js").Memory | null} */
  let memory = null;

  const ready = claimMemory().then((claimed) => {
    memory = claimed;
    set(uploads.fromLists(claimed.found));
  });

  /** @param {Item[]} next */
  function set(next) {
    items = next;
    memory?.write(uploads.toStorage(items));
    onChange(items);
  }
  const change = (/** @type {string} */ key, /** @type {Partial<Item>} */ values) =>
    set(uploads.withItem(items, key, values));

  /** @param {Item} item @param {File} file */
  async function send({ key, url, size }, file) {
    const control = new AbortController();
    running.set(key, control);
    change(key, { status: "sending", message: "" });
    try {
      const id = await sendFile(file, {
        url,
        signal: control.signal,
        onProgress: ({ trouble, ...progress }) => {
          const message = trouble === undefined ? {} : { message: trouble && messageOf(trouble) };
          change(key, { ...progress, ...message });
        },
      });
      // What a zip holds, the server alone can tell.
      const kind = /\.zip$/i.test(file.name) ? (await getUpload(id)).kind : null;
      change(key, { status: "done", id, offset: size, kind });
    } catch (error) {
      if (!control.signal.aborted) change(key, { status: "refused", message: reasonOf(error) });
    }
    running.delete(key);
    work();
  }

  function work() {
    for (const item of uploads.nextToSend(items, SLOTS)) {
      if (item.file) void send(item, item.file);
    }
  }

  /** What was complete before a reload may be gone, and what was not may be complete. */
  async function restore() {
    await ready;
    for (const { key, url } of items.filter((item) => !item.file)) {
      try {
        const upload = await getUpload(url?.split("/").pop() ?? "");
        const done = upload.complete ? { id: upload.id, kind: upload.kind, status: /** @type {const} */ ("done") } : {};
        change(key, { offset: upload.offset, ...done });
      } catch (error) {
        if (error instanceof ApiError && error.status === 404) {
          set(items.filter((item) => item.key !== key));
        }
      }
    }
  }

  return {
    restore,
    /** @param {{file: File, folder: string}[]} chosen */
    add(chosen) {
      // One that was begun before goes on where it was.
      void ready.then(() => {
        set(uploads.withFiles(items, chosen));
        work();
      });
    },
    /** Stop and forget files, here and on the server. @param {string[]} keys */
    remove(keys) {
      const gone = items.filter((item) => keys.includes(item.key));
      set(items.filter((item) => !keys.includes(item.key)));
      for (const { key, url } of gone) {
        running.get(key)?.abort();
        if (url) void removeUpload(url);
      }
      work();
    },
    /** The flight that they were sent for has them now. */
    clear() {
      set([]);
    },
  };
}

/** @param {unknown} error */
function reasonOf(error) {
  const unreadable = error instanceof DOMException;
  return unreadable ? "The file cannot be read: it was moved or changed." : messageOf(error);
}
