/** Small helpers for drawings in SVG. */

const NAMESPACE = "http://www.w3.org/2000/svg";

/**
 * An SVG element.
 * @param {string} name
 * @param {Record<string, string | number>} [attributes]
 * @param {string} [text]
 * @returns {SVGElement}
 */
export function draw(name, attributes = {}, text = "") {
  const element = /** @type {SVGElement} */ (document.createElementNS(NAMESPACE, name));
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  if (text) element.textContent = text;
  return element;
}

/**
 * An SVG element that shows its title where the pointer rests.
 * @param {SVGElement} element
 * @param {string} title
 * @returns {SVGElement}
 */
export function titled(element, title) {
  element.append(draw("title", {}, title));
  return element;
}
