/**
 * The pad under the seams of its sheets.
 *
 * @typedef {import("../padLogic.js").PadView} PadView
 * @typedef {import("../printLogic.js").SheetPlan} SheetPlan
 */

import { size } from "../../shared/formatLogic.js";
import { paintPad } from "./padPainter.js";
import { draw, titled } from "./svg.js";

const BORDER_PX = 2;
const FONT_PX = 12;
// Names of sheets smaller than this would run into each other.
const NAMED_FROM_PX = 26;
// "A1" alone is a paper size, too.
const FULLY_FROM_PX = 72;

/** @param {HTMLElement} root  holds a canvas and an SVG over it */
export function mountSheetPreview(root) {
  const canvas = /** @type {HTMLCanvasElement} */ (root.querySelector("canvas"));
  const svg = /** @type {SVGSVGElement} */ (root.querySelector("svg"));
  /** @type {{pad: PadView | null, plan: SheetPlan | null}} */
  let state = { pad: null, plan: null };

  function paint() {
    const { pad, plan } = state;
    root.hidden = !pad || !plan;
    if (!pad || !plan || !canvas.clientWidth) return;
    const view = { width: canvas.clientWidth, height: canvas.clientHeight };
    const [width, height] = plan.page_mm;
    const scale = Math.min(
      (view.width - 2 * BORDER_PX) / width,
      (view.height - 2 * BORDER_PX) / height,
    );
    paintPad(canvas, pad, "print", { x: width / 2, y: height / 2, scale });
    svg.setAttribute("viewBox", `0 0 ${view.width} ${view.height}`);
    svg.setAttribute("aria-label", `Plan of the sheets: ${plan.rows} × ${plan.cols}`);
    const left = (view.width - width * scale) / 2;
    const top = (view.height - height * scale) / 2;
    const narrowest = scale * Math.min(...plan.sheets.map(({ core_mm: [x0, , x1] }) => x1 - x0));
    const word = narrowest < FULLY_FROM_PX ? "" : "Sheet ";
    svg.replaceChildren(...plan.sheets.flatMap((sheet) => drawSheet(plan, sheet, { left, top, scale, word })));
  }
  new ResizeObserver(paint).observe(canvas);

  return {
    /** @param {{pad: PadView | null, plan: SheetPlan | null}} next */
    update(next) {
      if (next.pad === state.pad && next.plan === state.plan) return;
      state = next;
      paint();
    },
  };
}

/**
 * @param {SheetPlan} plan
 * @param {SheetPlan["sheets"][number]} sheet
 * @param {{left: number, top: number, scale: number, word: string}} place  the word before names
 * @returns {SVGElement[]}
 */
function drawSheet(plan, sheet, { left, top, scale, word }) {
  const [x0, y0, x1, y1] = sheet.core_mm;
  const box = {
    x: left + x0 * scale,
    y: top + y0 * scale,
    width: (x1 - x0) * scale,
    height: (y1 - y0) * scale,
  };
  const about = `Sheet ${sheet.name}: ${size(x1 - x0, y1 - y0)} of the pad's page`;
  const shapes = [titled(draw("rect", { ...box, class: "sheet" }), about)];
  if (plan.count > 1 && Math.min(box.width, box.height) >= NAMED_FROM_PX) {
    const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
    const name = word + sheet.name;
    shapes.push(draw("text", { ...middle, dy: FONT_PX * 0.36, class: "sheet-name", "font-size": FONT_PX }, name));
  }
  return shapes;
}
