/**
 * The files of a calibration, with their bars.
 *
 * @typedef {import("../calibrationRun.js").PictureFile} PictureFile
 */

import { keyedRows } from "../../shared/components/keyedRows.js";
import { bytes, number } from "../../shared/formatLogic.js";

/**
 * @param {HTMLElement} root
 * @param {{onRemove: (key: string | null) => void}} events  null: all of them
 */
export function mountPictureFiles(root, { onRemove }) {
  const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  find("clear").addEventListener("click", () => onRemove(null));
  const list = keyedRows(find("list"), /** @type {HTMLTemplateElement} */ (root.querySelector("template")), {
    make: (part, key) => part("remove").addEventListener("click", () => onRemove(key)),
    fill: (part, element, row) => {
      element.toggleAttribute("data-troubled", Boolean(row.note));
      part("title").textContent = part("title").title = row.name;
      part("note").textContent = row.note || row.size;
      part("remove").setAttribute("aria-label", `Remove ${row.name}`);
      /** @type {HTMLProgressElement} */ (part("bar")).value = row.share;
      part("bar").setAttribute("aria-label", `${row.name}, sent`);
    },
  });

  return {
    /** @param {{files: PictureFile[]}} state */
    update({ files }) {
      root.hidden = !files.length;
      find("total").textContent = files.length === 1 ? "1 file" : `${number(files.length)} files`;
      list.update(files.map(({ key, file, share, note }) => ({ key, share, note, name: file.name, size: bytes(file.size) })));
    },
  };
}
