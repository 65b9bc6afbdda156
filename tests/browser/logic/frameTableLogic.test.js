import {
  PAGE_FRAMES, filterFault, filterFromText, filterToText, noFilter, pageOf, placeBeside, rowOf,
} from "/static/js/flight/frameTableLogic.js";
import { equal } from "./check.js";

const failed = (frame) => ({
  source: "a.mp4", frame, time_s: frame / 10, status: "failed", stage: "decode", reason: "unknown_code",
  detail: "none of 3 windows is in the pad", elapsed_ms: {},
});
const full = Array.from({ length: PAGE_FRAMES }, (_, at) => failed(100 + at));

export const tests = {
  "a filter comes back from the address as it was": () => {
    const filters = [
      null,
      noFilter(),
      { ...noFilter(), status: "failed", reason: "motion_blur" },
      { ...noFilter(), quality: "bearing" },
      { ...noFilter(), layer: "red", from_s: 0, to_s: 12.5, min_height: 1500, max_height: 0 },
    ];
    for (const filter of filters) equal(filterFromText(filterToText(filter)), filter);
    equal(filterToText(null), null);
    equal(filterToText(noFilter()), "all");
  },
  "nonsense in the address asks for nothing": () => {
    equal(filterFromText("from_s=soon&to_s=Infinity&what=1"), noFilter());
    equal(filterFromText(""), null);
  },
  "ranges that hold no frame are told": () => {
    equal(filterFault(noFilter()), "");
    equal(filterFault({ ...noFilter(), from_s: 1, to_s: 2, min_height: 5, max_height: 5 }), "");
    equal(Boolean(filterFault({ ...noFilter(), from_s: 2, to_s: 2 })), true);
    equal(Boolean(filterFault({ ...noFilter(), min_height: 6, max_height: 5 })), true);
  },
  "pages know whether others are beside them": () => {
    const sides = ({ earlier, later }) => [earlier, later];
    equal(sides(pageOf({ items: full, next_after: 124 }, {})), [false, true]);
    equal(sides(pageOf({ items: full, next_after: 124 }, { after: 99 })), [true, true]);
    equal(sides(pageOf({ items: full.slice(3), next_after: null }, { after: 99 })), [true, false]);
    equal(sides(pageOf({ items: full, next_after: null }, { before: 125 })), [true, true]);
  },
  "the next page begins behind this one, the last ends before it": () => {
    const page = { items: full, earlier: true, later: true };
    equal([placeBeside(page, 1), placeBeside(page, -1)], [{ after: 124 }, { before: 100 }]);
    equal(placeBeside({ ...page, items: [] }, 1), {});
  },
  "a row says what became of its frame": () => {
    const bad = rowOf(failed(12), 12);
    equal([bad.outcome, bad.kind, bad.height, bad.time, bad.current], ["unknown code", "failed", "", "0:01.20", true]);
    const good = rowOf({
      source: "a.mp4", frame: 3, time_s: null, status: "ok", layer: "blue", position_mm: [120.4, -8, 2500],
      cells_read: 40, cells_wrong: 2, elapsed_ms: {},
    }, 12);
    equal([good.outcome, good.kind, good.height, good.time, good.current], ["blue", "blue", "2.50 m", "", false]);
    equal([good.place, good.detail], ["120 mm, −8.0 mm", "40 cells read, 2 wrong"]);
    const far = rowOf({
      source: "a.mp4", frame: 3, time_s: null, status: "ok", layer: "blue", position_mm: [4000, 2000, 15000],
      quality: "bearing", range_mm: 15500, range_sigma_mm: 80, bearing: [0, 0, 1], elapsed_ms: {},
    }, 12);
    equal([far.outcome, far.kind, far.height, far.place], ["blue, bearing only", "bearing", "", ""]);
    equal(far.detail, "15.50 m ± 80.0 mm, straight ahead");
  },
};
