/** Figures as people read them. Pure functions; figures keep a hyphen-free minus sign. */

/** Thin space between thousands, as in 14 641. */
const THIN = "\u202f";

/**
 * A number with grouped thousands and a fixed count of decimals.
 * @param {number} value
 * @param {number} [decimals]
 * @returns {string}
 */
export function number(value, decimals = 0) {
  const [whole, fraction] = Math.abs(value).toFixed(decimals).split(".");
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, THIN) : whole;
  const zero = Number(whole) === 0 && !Number(fraction ?? 0);
  const sign = value < 0 && !zero ? "−" : "";
  return sign + grouped + (fraction ? `.${fraction}` : "");
}

/**
 * A number without trailing zeros, to at most so many decimals.
 * @param {number} value
 * @param {number} [decimals]
 * @returns {string}
 */
export function compact(value, decimals = 3) {
  const text = number(value, decimals);
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** @param {number} count @returns {string} such as "1 frame" */
export const framesInWords = (count) => (count === 1 ? "1 frame" : `${number(count)} frames`);

/**
 * A length in the unit that reads best: millimetres below two metres.
 * @param {number} mm
 * @returns {string}
 */
export function length(mm) {
  const size = Math.abs(mm);
  if (size >= 2000) return `${number(mm / 1000, 2)} m`;
  if (size >= 100) return `${number(mm, 0)} mm`;
  return `${number(mm, 1)} mm`;
}

/**
 * A pad's size.
 * @param {number} widthMm
 * @param {number} heightMm
 * @returns {string}
 */
export function size(widthMm, heightMm) {
  return `${compact(widthMm, 2)} × ${compact(heightMm, 2)} mm`;
}

/**
 * A duration.
 * @param {number} ms
 * @returns {string}
 */
export function duration(ms) {
  if (ms >= 10_000) return `${number(ms / 1000, 1)} s`;
  if (ms >= 1000) return `${number(ms / 1000, 2)} s`;
  if (ms < 0.05) return "< 0.1 ms";
  return ms >= 10 ? `${number(ms)} ms` : `${number(ms, 1)} ms`;
}

/**
 * A file's size.
 * @param {number} count
 * @returns {string}
 */
export function bytes(count) {
  const units = ["B", "kB", "MB", "GB"];
  const power = Math.min(Math.floor(Math.log10(Math.max(count, 1)) / 3), units.length - 1);
  const value = count / 1000 ** power;
  return `${number(value, power && value < 100 ? 1 : 0)} ${units[power]}`;
}

/**
 * A share in percent; never 100 % or 0 % where a part is missing or there.
 * @param {number} part
 * @param {number} whole
 * @returns {string}
 */
export function percent(part, whole) {
  if (!whole) return "–";
  const value = (100 * part) / whole;
  if (value > 0 && value < 0.1) return "< 0.1 %";
  if (value > 99.9 && value < 100) return "> 99.9 %";
  return `${compact(value, value > 99 || value < 1 ? 1 : 0)} %`;
}

/**
 * A time within a flight, such as 0:04.33 or 1:02:07.10.
 * @param {number} seconds
 * @param {number} [decimals]
 * @returns {string}
 */
export function clock(seconds, decimals = 2) {
  const unit = 10 ** decimals;
  const ticks = Math.round(Math.max(seconds, 0) * unit);
  const whole = Math.floor(ticks / unit);
  const pad = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const fraction = decimals ? `.${String(ticks % unit).padStart(decimals, "0")}` : "";
  const minutes = Math.floor(whole / 60) % 60;
  const hours = Math.floor(whole / 3600);
  return `${hours ? `${hours}:${pad(minutes)}` : minutes}:${pad(whole % 60)}${fraction}`;
}

/**
 * Ten to a power that no float holds, for example 10⁻³⁰⁰.
 * @param {number} exponent
 * @returns {string}
 */
export function powerOfTen(exponent) {
  const digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const rounded = Math.round(exponent);
  const text = [...String(Math.abs(rounded))].map((digit) => digits[Number(digit)]).join("");
  return `10${rounded < 0 ? "⁻" : ""}${text}`;
}

/**
 * A stored date as a local day and time.
 * @param {string} iso
 * @returns {string}
 */
export function moment(iso) {
  const date = new Date(iso);
  if (Number.isNaN(date.getTime())) return "";
  return date.toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });
}
