/**
 * Every parameter beside its stage: slider, number, reset, unit, meaning.
 *
 * @typedef {import("../../server/tuningApi.js").Parameter} Parameter
 * @typedef {import("./paramsLogic.js").Values} Values
 */

import { stageTitle } from "../stagesLogic.js";
import { STEPS, byStage, faultOf, nameInWords, positionOf, valueAt } from "./paramsLogic.js";
import { STAGE_ORDER } from "./workbenchLogic.js";

// As in workbench.css: from here on the parameters stand beside the views.
const ROOMY = window.matchMedia("(min-width: 1001px)");

/**
 * @param {HTMLElement} root  holds the list and the templates of a stage and of a parameter
 * @param {object} events
 * @param {(parameter: Parameter, value: number | boolean, isDragged: boolean) => void} events.onValue
 */
export function mountParamsPanel(root, { onValue }) {
  const list = /** @type {HTMLElement} */ (root.querySelector("[data-ref=params]"));
  /** @type {Map<string, {update: (values: Values, all: Parameter[]) => void}>} */
  const rows = new Map();
  /** @type {Map<string, {element: HTMLDetailsElement, items: Parameter[]}>} */
  const groups = new Map();
  let shown = "";

  /** @param {string} name @returns {any} */
  const clone = (name) =>
    /** @type {HTMLTemplateElement} */ (root.querySelector(`template[data-ref=${name}]`)).content.firstElementChild
      ?.cloneNode(true);

  /** @param {Parameter} parameter */
  function rowOf(parameter) {
    const element = clone("param");
    const part = (/** @type {string} */ name) => element.querySelector(`[data-ref=${name}]`);
    const isBool = parameter.kind === "bool";
    const id = `param-${parameter.name.replace(".", "-")}`;
    const [slider, number, check] = [part("slider"), part("number"), part("check")];
    part("name").textContent = nameInWords(parameter.name);
    part("name").htmlFor = id;
    (isBool ? check : number).id = id;
    element.dataset.name = parameter.name;
    part("unit").textContent = parameter.unit;
    part("text").textContent = parameter.text.replaceAll("`", "") + (parameter.followed ? " It counts only while a video is followed: run the flight again to see it." : "");
    slider.max = STEPS;
    slider.setAttribute("aria-label", nameInWords(parameter.name));
    part("reset").setAttribute("aria-label", `Reset ${nameInWords(parameter.name)}`);
    slider.hidden = number.hidden = isBool;
    check.hidden = !isBool;
    number.step = parameter.kind === "int" ? 1 : "any";
    slider.addEventListener("input", () => onValue(parameter, valueAt(parameter, Number(slider.value)), true));
    slider.addEventListener("change", () => onValue(parameter, valueAt(parameter, Number(slider.value)), false));
    // Answers that come in while a number is typed must not write over it.
    let isTyped = false;
    number.addEventListener("input", () => (isTyped = true));
    number.addEventListener("blur", () => (isTyped = false));
    number.addEventListener("change", () => {
      isTyped = false;
      onValue(parameter, number.value === "" ? NaN : Number(number.value), false);
    });
    check.addEventListener("change", () => onValue(parameter, check.checked, false));
    part("reset").addEventListener("click", () => onValue(parameter, parameter.default, false));
    rows.set(parameter.name, {
      update(values, all) {
        const value = values[parameter.name] ?? parameter.default;
        element.toggleAttribute("data-changed", parameter.name in values);
        part("changed").hidden = !(parameter.name in values);
        part("reset").disabled = !(parameter.name in values);
        const fault = faultOf(parameter, value, values, all);
        part("fault").textContent = fault;
        number.setAttribute("aria-invalid", String(Boolean(fault)));
        check.checked = Boolean(value);
        if (isBool) return;
        slider.value = positionOf(parameter, Number(value));
        slider.setAttribute("aria-valuetext", `${value} ${parameter.unit}`);
        if (!isTyped) number.value = Number.isNaN(value) ? "" : String(value);
      },
    });
    return element;
  }

  /** @param {Parameter[]} all @param {string} method */
  function build(all, method) {
    rows.clear();
    groups.clear();
    const elements = byStage(all, method, STAGE_ORDER).map(({ stage, items }) => {
      const element = clone("params-stage");
      element.dataset.stage = stage;
      element.querySelector("[data-ref=title]").textContent = stageTitle(stage);
      element.querySelector("[data-ref=items]").replaceChildren(...items.map(rowOf));
      groups.set(stage, { element, items });
      return element;
    });
    list.replaceChildren(...elements);
  }

  let opened = "";
  return {
    /** @param {{all: Parameter[], method: string, values: Values, stage: string}} state */
    update({ all, method, values, stage }) {
      if (!all.length) return;
      if (shown !== method) {
        shown = method;
        opened = "";
        build(all, method);
      }
      for (const row of rows.values()) row.update(values, all);
      for (const { element, items } of groups.values()) {
        const count = items.filter(({ name }) => name in values).length;
        const note = /** @type {HTMLElement} */ (element.querySelector("[data-ref=count]"));
        note.textContent = count ? `${count} changed` : "";
      }
      if (opened !== stage && groups.has(stage)) {
        opened = stage;
        // On a narrow page the list would push the stages out of sight.
        if (!ROOMY.matches) return;
        for (const [name, { element }] of groups) if (name === stage) element.open = true;
      }
    },
  };
}
