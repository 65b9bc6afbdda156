/**
 * Where a tab keeps the list of its uploads over a reload. Each tab has a list of its own: what one tab sends
 * is no file of another's flight, and none to remove there. Lists of tabs that are closed are taken over.
 *
 * @typedef {object} Memory
 * @property {string[]} found  lists of before: its own, and those of closed tabs
 * @property {(text: string) => void} write
 */

const KEY = "padstudio.uploads";
// A tab that is loaded anew may have to wait until its last page has let go.
const HELD_MS = 500;

/** @returns {Promise<Memory>} */
export async function claimMemory() {
  const id = await ownId();
  const key = `${KEY}.${id}`;
  const found = [stored(() => localStorage.getItem(key))];
  for (const other of keysOfOthers(key)) {
    if (await isClosed(other)) found.push(taken(other));
  }
  return {
    found: found.filter((text) => text !== null),
    write: (text) => void stored(() => localStorage.setItem(key, text)),
  };
}

/** Of this tab, also after a reload; a tab that was made of another's copy gets one of its own. */
async function ownId() {
  const before = stored(() => sessionStorage.getItem(KEY));
  if (before && (await isHeld(before))) return before;
  const id = [...crypto.getRandomValues(new Uint32Array(2))].map((part) => part.toString(36)).join("");
  stored(() => sessionStorage.setItem(KEY, id));
  await isHeld(id);
  return id;
}

/** Hold a list for as long as the page is there. @param {string} id @returns {Promise<boolean>} false where another tab does */
function isHeld(id) {
  if (!navigator.locks) return Promise.resolve(true);
  return new Promise((resolve) => {
    navigator.locks
      .request(`${KEY}.${id}`, { signal: AbortSignal.timeout(HELD_MS) }, () => {
        resolve(true);
        return new Promise(() => undefined);
      })
      .catch(() => resolve(false));
  });
}

/** @param {string} own @returns {string[]} */
function keysOfOthers(own) {
  const all = stored(() => Object.keys(localStorage)) ?? [];
  return all.filter((key) => key !== own && (key === KEY || key.startsWith(`${KEY}.`)));
}

/** A browser without locks, as on plain HTTP, cannot tell, and leaves it. @param {string} key */
const isClosed = async (key) =>
  Boolean(navigator.locks) && navigator.locks.request(key, { ifAvailable: true }, (lock) => lock !== null);

/** @param {string} key */
const taken = (key) =>
  stored(() => {
    const text = localStorage.getItem(key);
    localStorage.removeItem(key);
    return text;
  });

/** Without storage an upload does not outlive a reload, and that is all. @template T @param {() => T} act @returns {T | null} */
function stored(act) {
  try {
    return act();
  } catch {
    return null;
  }
}
