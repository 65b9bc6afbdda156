/**
 * The stored cameras, and the presets.
 *
 * @typedef {import("../../server/api.js").CameraSummary} CameraSummary
 */

import { CAMERA_FORMS, cameraFileUrl } from "../../server/api.js";
import { keyedRows } from "../../shared/components/keyedRows.js";
import { moment, number } from "../../shared/formatLogic.js";

/** @param {HTMLElement} root */
export function mountCameraList(root) {
  const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(`[data-ref=${name}]`));
  const template = /** @type {HTMLTemplateElement} */ (root.querySelector("template"));
  const lists = ["list", "presets"].map((name) =>
    keyedRows(find(name), template, {
      fill: (part, _, row) => {
        part("title").textContent = row.name;
        part("note").textContent = row.note;
        part("open").title = "Use it on Diagnose";
        /** @type {HTMLAnchorElement} */ (part("open")).href = row.href;
        const file = /** @type {HTMLAnchorElement} */ (part("file"));
        file.hidden = !row.file;
        file.href = row.file;
        file.textContent = row.form;
        file.setAttribute("aria-label", `Download ${row.name} as of ${row.form}`);
      },
    }),
  );

  return {
    /**
     * @param {{stored: CameraSummary[] | null, presets: CameraSummary[]}} cameras  null before they are known
     * @param {string} form  in which they are saved
     */
    update({ stored, presets }, form) {
      find("empty").hidden = stored?.length !== 0;
      lists[0].update((stored ?? []).map((camera) => rowOf(camera, form)));
      lists[1].update(presets.map((camera) => rowOf(camera, form)));
    },
  };
}

/** @param {CameraSummary} camera @param {string} form */
function rowOf(camera, form) {
  const { id, name, width, height, focal_px: focal, model, created_at: made, note } = camera;
  const parts = [`${width} × ${height} px`, `focal length ${number(focal)} px`, ...(model === "fisheye" ? ["fisheye"] : [])];
  if (made) parts.push(moment(made), ...(note ? [note] : []));
  return {
    key: id,
    name,
    note: parts.join(" · "),
    href: `/diagnose?camera=${encodeURIComponent(id)}`,
    form,
    file: canBeSaved(camera, form) ? cameraFileUrl(id, CAMERA_FORMS[form]) : "",
  };
}

/** Kalibr has no radial-tangential lens of more than four coefficients. @param {CameraSummary} camera @param {string} form */
const canBeSaved = ({ model, distortion }, form) =>
  form !== "Kalibr" || model === "fisheye" || !distortion.slice(4).some(Boolean);
