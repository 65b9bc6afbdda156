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
  let timer = 0;
  /** @type {AbortController | null} */
  let running = null;

  /** @param {(signal: AbortSignal) => Promise<T>} question */
  async function send(question) {
    running = new AbortController();
    try {
      onAnswer(await question(running.signal), "");
    } catch (error) {
      if (!isAbort(error)) onAnswer(null, messageOf(error));
    }
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
      window.clearTimeout(timer);
      running?.abort();
      // Who asks may be in the midst of showing the last answer.
      if (!key) timer = window.setTimeout(() => onAnswer(null, ""), 0);
      else timer = window.setTimeout(() => void send(question), isFirst ? 0 : DELAY_MS);
    },
  };
}
