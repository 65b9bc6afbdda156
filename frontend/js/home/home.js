/**
 * The controller of the first page: everything that the studio holds.
 *
 * @typedef {import("../server/libraryApi.js").Kind} Kind
 * @typedef {import("./homeLogic.js").Card} Card
 *
 * @typedef {object} State
 * @property {Record<Kind, Card[] | null>} cards  null before they are known
 * @property {Kind[]} all  kinds that are shown whole
 * @property {string} search
 * @property {string} order
 * @property {Card[]} leaving  deleted, unless somebody undoes it
 * @property {import("../shared/components/status.js").Status} status
 */

import { readAddress, writeAddress } from "../shared/address.js";
import { loadFault, mountStatus } from "../shared/components/status.js";
import * as library from "../server/libraryApi.js";
import { previewUrl } from "../server/flightsApi.js";
import { messageOf } from "../server/request.js";
import { mountRenameDialog } from "./components/renameDialog.js";
import { mountShelf } from "./components/shelf.js";
import { cardOf, knownOrder, matching, sorted } from "./homeLogic.js";
import { makeRemovals } from "./removals.js";
import { mountFooter } from "../shared/components/footer.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const KINDS = /** @type {Kind[]} */ (["flights", "pads", "cameras"]);
const LOOK_EVERY_MS = 2000;
const address = readAddress();

/** @type {State} */
const state = {
  cards: { flights: null, pads: null, cameras: null },
  all: [],
  search: address.get("search") ?? "",
  order: knownOrder(address.get("order") ?? ""),
  leaving: [],
  status: null,
};

const renaming = mountRenameDialog(byId("rename"), {
  onRename: async (card, name) => {
    await library.rename(card.kind, card.id, name);
    await load(card.kind);
  },
});
const removals = makeRemovals({
  onChange: (leaving) => {
    // Gone for good: the list must not bring it back before it is asked for again.
    const gone = state.leaving.filter((card) => !leaving.includes(card));
    set({ leaving });
    new Set(gone.map((card) => card.kind)).forEach((kind) => void load(kind));
  },
  onFault: (card, error) => set({ status: { kind: "bad", text: `${card.name}: ${messageOf(error)}` } }),
});
const shelves = KINDS.map((kind) => ({
  kind,
  shelf: mountShelf(byId(kind), byId("card"), {
    onRename: renaming.open,
    onRemove: removals.add,
    onAll: () => set({ all: [...state.all, kind] }),
    picture: (card) => pictureOf(card),
  }),
}));
const status = mountStatus(byId("status"));

/** @param {Card} card */
function pictureOf({ kind, id, frame = null }) {
  if (kind !== "flights") return library.thumbnailUrl(kind, id);
  return frame === null ? "" : previewUrl(id, frame);
}

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  const leaving = new Set(state.leaving.map((card) => card.key));
  for (const { kind, shelf } of shelves) {
    const cards = (state.cards[kind] ?? []).filter((card) => !leaving.has(card.key));
    const total = state.cards[kind] && cards.length;
    const shown = sorted(matching(cards, state.search), state.order);
    shelf.update({ cards: shown, total, isAll: state.all.includes(kind) || Boolean(state.search) });
  }
  byId("welcome").hidden = KINDS.some((kind) => state.cards[kind]?.length !== 0);
  byId("undo").hidden = !state.leaving.length;
  const last = state.leaving.at(-1);
  byId("undo").querySelector("[data-ref=text]").textContent = last ? `Deleted “${last.name}”.` : "";
  status.update(state.status);
}

/** @param {Kind} kind */
async function load(kind) {
  try {
    const cards = (await library.LISTS[kind]()).map((item) => cardOf[kind](item));
    // What has come at last is no longer missing.
    set({ cards: { ...state.cards, [kind]: cards }, ...(state.status?.again ? { status: null } : {}) });
  } catch (error) {
    set({ status: loadFault(error, () => void loadAll()) });
  }
}

const loadAll = () => Promise.all(KINDS.map(load));

async function trySample() {
  set({ status: { kind: "quiet", text: "Taking the sample flight in …" } });
  try {
    const { id } = await library.sampleFlight();
    location.assign(`/flights/${id}`);
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error) } });
  }
}

/** Flights go on while the page is looked at. */
async function watch() {
  const isAtWork = state.cards.flights?.some((card) => card.progress !== null);
  if (isAtWork && !document.hidden) await load("flights");
  window.setTimeout(() => void watch(), LOOK_EVERY_MS);
}

byId("search").value = state.search;
byId("sort").value = state.order;
byId("search").addEventListener("input", () => {
  set({ search: byId("search").value });
  writeAddress({ search: state.search, order: state.order === "newest" ? null : state.order });
});
byId("sort").addEventListener("change", () => {
  set({ order: byId("sort").value });
  writeAddress({ search: state.search, order: state.order === "newest" ? null : state.order });
});
byId("sample-flight").addEventListener("click", () => void trySample());
byId("undo").querySelector("[data-ref=undo]").addEventListener("click", () => removals.undo());
document.addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof HTMLInputElement || event.ctrlKey || event.metaKey || event.altKey;
  if (event.key !== "/" || isTyping) return;
  event.preventDefault();
  byId("search").focus();
});
void loadAll().then(() => watch());
mountFooter();
