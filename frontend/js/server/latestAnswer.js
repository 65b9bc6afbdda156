/** Questions to the server that follow a form as it changes. */

import { isAbort, messageOf } from "./request.js";

const DELAY_MS = 150;

/**
 * Keeps one question under way; a new one takes its place, the same one is not asked again.
 * @template T
 * @param {(answer: T | null, fault: string) => void} onAnswer
 */
export function makeLatestAnswer(onAnswer) {
  let asked = "";
  let waits = false;
  let timer = 0;
  /** @type {AbortController | null} */
  let running = null;

  /** @param {(signal: AbortSignal) => Promise<T>} question */
  async function send(question) {
    running = new AbortController();
    try {
      tell(await question(running.signal), "");
    } catch (error) {
      if (!isAbort(error)) tell(null, messageOf(error));
    }
  }

  /** @param {T | null} answer @param {string} fault */
  function tell(answer, fault) {
    waits = false;
    onAnswer(answer, fault);
  }

  return {
    /**
     * @param {string} key  says what is asked; empty for nothing
     * @param {(signal: AbortSignal) => Promise<T>} question
     */
    ask(key, question) {
      if (key === asked) return;
      const isFirst = !asked;
      asked = key;
      waits = true;
      window.clearTimeout(timer);
      running?.abort();
      // Who asks may be in the midst of showing the last answer.
      if (!key) timer = window.setTimeout(() => tell(null, ""), 0);
      else timer = window.setTimeout(() => void send(question), isFirst ? 0 : DELAY_MS);
    },
    /** Whether the last answer is to an older question than the one asked. */
    waits: () => waits,
  };
}
