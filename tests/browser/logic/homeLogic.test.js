import { cardOf, knownOrder, matching, sorted } from "/static/js/home/homeLogic.js";
import { contains, equal } from "./check.js";

const pad = {
  id: "1", name: "Roof", created_at: "2026-11-02T08:00:00Z", size_mm: [600, 400], window: 5, levels: 2,
  layers: [{ channel: "red", rows: 40, cols: 60, cell_mm: 10 }, { channel: "blue", rows: 8, cols: 12, cell_mm: 50 }],
};
const camera = { id: "2", name: "nose 10", created_at: "2026-11-03T08:00:00Z", width: 848, height: 480, focal_px: 588, model: "radtan" };
const flight = {
  id: "3", name: "nose 9", created_at: "2026-11-01T08:00:00Z", state: "running", progress: 0.25, frames_total: 8,
  frames_done: 2, frames_ok: 1, error: null, notice: null, request: {},
};
const cards = [cardOf.pads(pad), cardOf.cameras(camera), cardOf.flights(flight)];
const names = (shown) => shown.map((card) => card.name);

export const tests = {
  "every kind has its page, its sizes and its date": () => {
    equal(cards.map((card) => card.href), ["/design?pad=1", "/plan?camera=2", "/flights/3"]);
    contains(cards[0].note, "600 × 400 mm");
    contains(cards[0].note, "60 × 40 and 12 × 8");
    contains(cards[1].note, "848 × 480");
    equal(cards.every((card) => card.date.length > 0), true);
  },
  "a flight's picture is of a frame that it has read": () => {
    const frame = (change) => cardOf.flights({ ...flight, state: "done", ...change }).frame;
    equal([frame({}), frame({ request: { first_frame: 30 } })], [0, 30]);
    equal([frame({ state: "running" }), frame({ request: { only: { flight: "1", reason: null } } })], [null, null]);
  },
  "a flight at work tells how far it is, one that is done does not": () => {
    equal(cards[2].progress, 0.25);
    equal(cardOf.flights({ ...flight, state: "done" }).progress, null);
    contains(cardOf.flights({ ...flight, state: "failed", error: { code: "x", message: "no frames" } }).note, "no frames");
  },
  "a search finds every word in name, sizes or date, in any letters": () => {
    equal(names(matching(cards, "NOSE")), ["nose 10", "nose 9"]);
    equal(names(matching(cards, "848 nose")), ["nose 10"]);
    equal(names(matching(cards, "  ")), ["Roof", "nose 10", "nose 9"]);
    equal(matching(cards, "roof nose"), []);
  },
  "orders: newest, oldest, by name with numbers as numbers": () => {
    equal(names(sorted(cards, "newest")), ["nose 10", "Roof", "nose 9"]);
    equal(names(sorted(cards, "oldest")), ["nose 9", "Roof", "nose 10"]);
    equal(names(sorted(cards, "name")), ["nose 9", "nose 10", "Roof"]);
    equal([knownOrder("name"), knownOrder("toString")], ["name", "newest"]);
  },
};
