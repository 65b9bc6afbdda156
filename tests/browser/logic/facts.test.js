import { mountFacts } from "/static/js/shared/components/facts.js";

import { equal } from "./check.js";

const ID = ["Id", "ab12", "ab12"];

function shown() {
  const list = document.body.appendChild(document.createElement("dl"));
  const facts = mountFacts(list);
  facts.update([["State", "queued"], ID, ["Gone", "soon"]]);
  return { list, facts, button: list.querySelector("button") };
}

const words = (list) => [...list.children].map((element) => element.textContent);

export const tests = {
  "terms and figures are told in their order": () => {
    equal(words(shown().list), ["State", "queued", "Id", "ab12 Copy id", "Gone", "soon"]);
  },

  "facts that come, change or go leave the order as it is given": () => {
    const { list, facts } = shown();
    facts.update([["Frames", "8"], ["State", "done"], ID, ["Last", "one"]]);
    equal(words(list), ["Frames", "8", "State", "done", "Id", "ab12 Copy id", "Last", "one"]);
    facts.update([ID, ["Frames", "8"]]);
    equal(words(list), ["Id", "ab12 Copy id", "Frames", "8"]);
    facts.update([]);
    equal(words(list), []);
  },

  "a fact that stays keeps its button, and the button the focus": () => {
    const { list, facts, button } = shown();
    button.focus();
    facts.update([["Frames", "8"], ["State", "done"], ID]);
    equal(list.querySelector("button") === button, true);
    equal(document.activeElement === button, true);
  },

  "another figure has a button of its own": () => {
    const { list, facts, button } = shown();
    facts.update([["Id", "cd34", "cd34"]]);
    equal(list.querySelector("button") === button, false);
    equal(words(list), ["Id", "cd34 Copy id"]);
  },
};
