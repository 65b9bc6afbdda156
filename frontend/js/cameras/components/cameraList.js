/**
 * The stored cameras, and the presets.
 *
 * @typedef {import("../../server/api.js").CameraSummary} CameraSummary
 */

import { cameraFileUrl } from "../../server/calibrationApi.js";
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
        /** @type {HTMLAnchorElement} */ (part("file")).href = cameraFileUrl(row.key);
        part("file").setAttribute("aria-label", `Download ${row.name} as ROS YAML`);
      },
    }),
  );

  return {
    /** @param {{stored: CameraSummary[] | null, presets: CameraSummary[]}} cameras  null before they are known */
    update({ stored, presets }) {
      find("empty").hidden = stored?.length !== 0;
      lists[0].update((stored ?? []).map(rowOf));
      lists[1].update(presets.map(rowOf));
    },
  };
}

/** @param {CameraSummary} camera */
function rowOf({ id, name, width, height, focal_px: focal, model, created_at: made }) {
  const parts = [`${width} × ${height} px`, `focal length ${number(focal)} px`, ...(model === "fisheye" ? ["fisheye"] : [])];
  if (made) parts.push(moment(made));
  return { key: id, name, note: parts.join(" · "), href: `/diagnose?camera=${encodeURIComponent(id)}` };
}
