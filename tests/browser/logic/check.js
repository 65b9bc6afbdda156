/** The few assertions that the tests of the page's logic need. */

/** @param {unknown} actual @param {unknown} expected */
export function equal(actual, expected) {
  const [a, b] = [actual, expected].map((value) => JSON.stringify(value, plain));
  if (a !== b) throw new Error(`is ${a}, expected ${b}`);
}

/** @param {number} actual @param {number} expected @param {number} [tolerance] */
export function near(actual, expected, tolerance = 1e-9) {
  if (!(Math.abs(actual - expected) <= tolerance)) throw new Error(`is ${actual}, expected ${expected}`);
}

/** @param {string} text @param {string} part */
export function contains(text, part) {
  if (!text.includes(part)) throw new Error(`${JSON.stringify(text)} does not contain ${part}`);
}

/** @param {string} _key @param {unknown} value */
function plain(_key, value) {
  if (typeof value === "bigint") return `${value}n`;
  if (typeof value === "number" && !Number.isFinite(value)) return String(value);
  return ArrayBuffer.isView(value) ? [...value] : value;
}
