/**
 * The controller of the Experiments page: one section a kind, all fed by one list.
 *
 * @typedef {import("../server/experimentsApi.js").Experiment} Experiment
 * @typedef {import("../server/experimentsApi.js").ExperimentDetail} ExperimentDetail
 *
 * @typedef {object} State
 * @property {Experiment[]} all
 * @property {ExperimentDetail | null} opened
 * @property {string} ordering  the kind that is being ordered
 * @property {{kind: string, status: import("../shared/components/status.js").Status}} said
 */

import { addressKeeper, readAddress } from "../shared/address.js";
import { mountFooter } from "../shared/components/footer.js";
import { loadFault } from "../shared/components/status.js";
import { getExperiment } from "../server/experimentsApi.js";
import { messageOf } from "../server/request.js";
import { mountExperimentSection } from "./components/experimentSection.js";
import { ofKind } from "./experimentLogic.js";
import { makeExperimentWatch } from "./experimentWatch.js";
import { budgetOrder } from "./forms/budgetForm.js";
import { mountChoices } from "./forms/choices.js";
import { reproductionOrder } from "./forms/reproductionForm.js";
import { shootoutOrder } from "./forms/shootoutForm.js";

/** What reads each kind's form. @type {Record<string, (form: HTMLFormElement) => Record<string, unknown>>} */
const FORMS = { reproduction: reproductionOrder, shootout: shootoutOrder, budget: budgetOrder };

/** @type {State} */
const state = { all: [], opened: null, ordering: "", said: { kind: "", status: null } };
/** The experiment that is opened as soon as it is done. */
let awaited = readAddress().get("experiment") ?? "";

const sections = Object.entries(FORMS).map(([kind, orderOf]) => {
  const root = /** @type {HTMLElement} */ (document.getElementById(kind));
  const form = /** @type {HTMLFormElement} */ (root.querySelector("form"));
  const section = mountExperimentSection(root, {
    onStart: () => void attempt(kind, () => start(kind, orderOf(form))),
    onOpen: (id) => void attempt(kind, () => open(id)),
    onRemove: (id) => void attempt(kind, () => remove(id)),
  });
  return { kind, section };
});
const watch = makeExperimentWatch({
  onList: (all) => {
    set({ all });
    if (all.some(({ id, state: now }) => id === awaited && now === "done")) void attempt("", () => open(awaited));
  },
  onFault: (error) => set({ said: { kind: sections[0].kind, status: loadFault(error) } }),
});
const keepAddress = addressKeeper(() => ({ experiment: state.opened?.id ?? awaited }));

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  for (const { kind, section } of sections) {
    section.update({
      all: ofKind(state.all, kind),
      opened: state.opened?.kind === kind ? state.opened : null,
      isOrdering: state.ordering === kind,
      status: state.said.kind === kind ? state.said.status : null,
    });
  }
  keepAddress();
}

/** @param {string} kind @param {() => Promise<void>} act */
async function attempt(kind, act) {
  try {
    await act();
  } catch (error) {
    set({ said: { kind, status: { kind: "bad", text: messageOf(error) } } });
  }
}

/** @param {string} kind @param {Record<string, unknown>} order */
async function start(kind, order) {
  set({ ordering: kind, said: { kind, status: null } });
  try {
    awaited = (await watch.start({ kind, ...order })).id;
  } finally {
    set({ ordering: "" });
  }
}

/** @param {string} id */
async function open(id) {
  awaited = "";
  set({ opened: await getExperiment(id), said: { kind: "", status: null } });
}

/** @param {string} id */
async function remove(id) {
  if (awaited === id) awaited = "";
  await watch.remove(id);
  if (state.opened?.id === id) set({ opened: null });
}

for (const kind of ["shootout", "budget"]) {
  const form = /** @type {HTMLFormElement} */ (document.querySelector(`#${kind} form`));
  void mountChoices(form, { kind, onStatus: (status) => set({ said: { kind, status } }) });
}
mountFooter();
set({});
void watch.look();
