/**
 * Copying to the clipboard: the one way to take along an id, a pose, a command line or a link.
 *
 * @typedef {(status: import("./status.js").Status) => void} OnStatus
 */

const TOLD_MS = 1500;
const REFUSED = "The browser does not allow copying here.";

/**
 * @param {string} text
 * @param {string} what  such as `the link`
 * @param {OnStatus} onStatus
 */
export async function copyText(text, what, onStatus) {
  try {
    await navigator.clipboard.writeText(text);
    onStatus({ kind: "ok", text: `Copied ${what}.` });
  } catch {
    onStatus({ kind: "bad", text: REFUSED });
  }
}

/**
 * Let a button copy what a text is at the time of the click; the button says that it did.
 * @param {HTMLElement} button
 * @param {() => string} text  an empty one is not copied
 */
export function mountCopy(button, text) {
  const words = [...button.childNodes];
  let timer = 0;

  /** @param {import("./status.js").Status} status */
  function tell(status) {
    window.clearTimeout(timer);
    button.textContent = status?.kind === "ok" ? "Copied" : REFUSED;
    timer = window.setTimeout(() => {
      button.replaceChildren(...words);
    }, TOLD_MS);
  }
  button.addEventListener("click", () => {
    const copied = text();
    if (copied) void copyText(copied, "", tell);
  });
}

/**
 * A small button that copies what stands beside it.
 * @param {string} text
 * @param {string} what  such as `id`
 * @returns {HTMLButtonElement}
 */
export function copyButton(text, what) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "copy";
  button.append("Copy", Object.assign(document.createElement("span"), { className: "visually-hidden", textContent: ` ${what}` }));
  mountCopy(button, () => text);
  return button;
}
