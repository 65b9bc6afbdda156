/**
 * Files that were dropped, with those in dropped folders.
 *
 * @typedef {{file: File, folder: string}} Chosen  `folder` is empty for a single file
 */

/**
 * What a file input holds.
 * @param {Iterable<File>} files
 * @returns {Chosen[]}
 */
export const chosenFrom = (files) =>
  [...files]
    .map((file) => {
      const path = file.webkitRelativePath;
      return { file, folder: path.slice(0, Math.max(0, path.lastIndexOf("/"))) };
    })
    .filter(({ file, folder }) => !folder || !isHidden(file.name));

/**
 * What was dropped. The entries must be asked for before anything is awaited.
 * @param {DataTransfer} data
 * @returns {Promise<Chosen[]>}
 */
export async function filesOf(data) {
  const entries = [...data.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  if (!entries.length) return chosenFrom(data.files);
  const found = await Promise.all(entries.map((entry) => walk(entry, "")));
  return found.flat();
}

/** @param {string} name */
const isHidden = (name) => name.startsWith(".") || /^(thumbs\.db|desktop\.ini)$/i.test(name);

/** @param {FileSystemEntry} entry @param {string} folder @returns {Promise<Chosen[]>} */
async function walk(entry, folder) {
  if (folder && isHidden(entry.name)) return [];
  if (entry.isFile) {
    const file = await new Promise((resolve, reject) => {
      /** @type {FileSystemFileEntry} */ (entry).file(resolve, reject);
    });
    return [{ file, folder }];
  }
  const reader = /** @type {FileSystemDirectoryEntry} */ (entry).createReader();
  const inner = folder ? `${folder}/${entry.name}` : entry.name;
  const found = [];
  for (;;) {
    // A reader gives its entries in parts, an empty one at the end.
    const part = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!part.length) return found;
    for (const each of part) found.push(...(await walk(each, inner)));
  }
}
