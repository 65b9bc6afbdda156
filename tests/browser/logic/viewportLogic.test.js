import {
  clamp, fit, keyMove, pan, scaleBar, toSheet, toView, viewportFromText, viewportToText, zoomAt,
} from "/static/js/shared/viewportLogic.js";
import { equal, near } from "./check.js";

const SHEET = { width: 1000, height: 500 };
const VIEW = { width: 624, height: 424 };

export const tests = {
  "fit shows the whole sheet within the border": () => {
    equal(fit(SHEET, VIEW), { x: 500, y: 250, scale: 0.6 });
    equal(fit(SHEET, VIEW, 0).scale, 0.624);
    equal(fit({ width: 500, height: 1000 }, VIEW).scale, 0.4);
  },
  "zooming keeps the place under the pointer": () => {
    const before = { x: 300, y: 200, scale: 2 };
    const point = { x: 120, y: -80 };
    const after = zoomAt(before, 3.7, point);
    near(toSheet(after, point).x, toSheet(before, point).x);
    near(toSheet(after, point).y, toSheet(before, point).y);
    near(after.scale, 7.4);
  },
  "dragging moves the sheet with the pointer": () => {
    const place = { x: 10, y: 20 };
    const before = { x: 300, y: 200, scale: 2 };
    const moved = toView(pan(before, 30, -8), place);
    near(moved.x, toView(before, place).x + 30);
    near(moved.y, toView(before, place).y - 8);
  },
  "view and sheet are inverse": () => {
    const viewport = { x: 3, y: 4, scale: 5 };
    equal(toSheet(viewport, toView(viewport, { x: 7, y: 9 })), { x: 7, y: 9 });
  },
  "clamp holds the middle on the sheet and the scale in bounds": () => {
    equal(clamp({ x: -5, y: 900, scale: 99 }, SHEET, VIEW, 10), { x: 0, y: 500, scale: 10 });
    near(clamp({ x: 1, y: 1, scale: 0.001 }, SHEET, VIEW, 10).scale, 0.3);
    near(clamp({ x: 1, y: 1, scale: 5 }, SHEET, VIEW, 0.01).scale, 0.3);
  },
  "a scale bar is the longest of 1, 2, 5 that fits": () => {
    equal(scaleBar(1, 120), { units: 100, pixels: 100 });
    equal(scaleBar(0.5, 120), { units: 200, pixels: 100 });
    equal(scaleBar(2, 119).units, 50);
    near(scaleBar(300, 120).units, 0.2);
  },
  "keys zoom, move and fit; others are left alone": () => {
    const at = { x: 100, y: 100, scale: 2 };
    near(keyMove(at, "+", 60).scale, 2.5);
    near(keyMove(at, "-", 60).scale, 1.6);
    equal(keyMove(at, "ArrowRight", 60), { x: 130, y: 100, scale: 2 });
    equal(keyMove(at, "ArrowUp", 60), { x: 100, y: 70, scale: 2 });
    equal([keyMove(at, "0", 60), keyMove(at, "q", 60)], ["fit", null]);
  },
  "the address keeps a viewport": () => {
    const viewport = { x: 12.34, y: 5.6, scale: 3.25 };
    equal(viewportFromText(viewportToText(viewport)), viewport);
    equal(viewportToText(null), null);
    for (const text of [null, "", "1,2", "1,2,0", "1,2,-3", "a,b,c", "1,,3"]) {
      equal(viewportFromText(text), null);
    }
  },
};
