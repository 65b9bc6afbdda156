/**
 * A calibration's result: how sure it is, what it lacks, its pictures, and the form that stores it.
 *
 * @typedef {import("../../server/calibrationApi.js").Calibration} Calibration
 */

import { residualPictureUrl } from "../../server/calibrationApi.js";
import { mountFacts } from "../../shared/components/facts.js";
import { keyedRows } from "../../shared/components/keyedRows.js";
import { readoutFrom } from "../../shared/readingLogic.js";
import {
  coverageCells, factsOf, parameterRow, pictureInWords, sigmaCells, verdictOf,
} from "../calibrationLogic.js";
import { drawLensMap } from "./lensMap.js";

/**
 * @param {HTMLElement} root
 * @param {{onStore: (wanted: {name: string | null, readout_ms: number | null}) => void,
 *   onPicture: (number: number) => void}} events
 */
export function mountCalibrationResult(root, { onStore, onPicture }) {
  const find = (/** @type {string} */ name) => /** @type {any} */ (root.querySelector(`[data-ref=${name}]`));
  const facts = mountFacts(find("facts"));
  const pictures = keyedRows(find("pictures"), /** @type {any} */ (root.querySelector("template")), {
    make: (part, key) => part("open").addEventListener("click", () => onPicture(Number(key))),
    fill: (part, element, row) => {
      element.dataset.state = row.state;
      part("title").textContent = row.name;
      part("note").textContent = pictureInWords(row);
      part("advice").textContent = row.message;
      part("open").setAttribute("aria-pressed", String(row.isShown));
    },
  });
  const [name, readout] = find("save").querySelectorAll("input");
  find("save").addEventListener("submit", (/** @type {Event} */ event) => {
    event.preventDefault();
    const { readout: readoutMs, fault } = readoutFrom(readout.value);
    find("readout-error").textContent = fault;
    readout.setAttribute("aria-invalid", String(Boolean(fault)));
    if (!fault) onStore({ name: name.value.trim() || null, readout_ms: readoutMs });
  });

  /** @param {import("../../server/calibrationApi.js").CalibrationResult} result */
  function show(result) {
    const { kind, text } = verdictOf(result);
    find("verdict").className = `notice notice-${kind}`;
    find("verdict").textContent = text;
    find("findings").replaceChildren(...result.findings.map(({ message }) => {
      const text = message[0].toUpperCase() + message.slice(1);
      return Object.assign(document.createElement("li"), { textContent: `${text}.` });
    }));
    facts.update(factsOf(result));
    find("parameters").replaceChildren(...[...result.intrinsics, ...result.distortion].map((parameter) => {
      const row = document.createElement("tr");
      row.append(...parameterRow(parameter).map((text) => Object.assign(document.createElement("td"), { textContent: text })));
      return row;
    }));
    const aspect = result.width / result.height;
    drawLensMap(find("coverage"), coverageCells(result.coverage), { label: "Points measured in each part of the picture", aspect });
    drawLensMap(find("sigma"), sigmaCells(result.sigma_px), { label: "One sigma of the lens in each part of the picture", aspect });
  }

  let shown = "";
  return {
    /** @param {{job: Calibration | null, picture: number, stored: string}} state */
    update({ job, picture, stored }) {
      const result = job?.result ?? null;
      root.hidden = !result;
      if (!job || !result) return;
      if (shown !== job.id) show(result);
      shown = job.id;
      pictures.update(result.pictures.map((each, at) => ({ key: String(at), isShown: at === picture, ...each })));
      const image = find("residual-picture");
      const url = residualPictureUrl(job.id, picture);
      if (image.getAttribute("src") !== url) image.src = url;
      image.alt = `${result.pictures[picture]?.name}: points measured and their residuals`;
      if (find("stored").textContent !== stored) find("stored").textContent = stored;
    },
  };
}
