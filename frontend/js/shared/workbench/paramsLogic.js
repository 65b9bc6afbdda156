/**
 * Parameters of the detector as sliders, links and command lines hold them.
 *
 * @typedef {import("../../server/tuningApi.js").Parameter} Parameter
 * @typedef {number | boolean} Value
 * @typedef {Record<string, Value>} Values  by name; only those that differ from their defaults
 */

/** Positions of a slider. */
export const STEPS = 1000;
// Over a wider range a slider moves by ratios, and from 0 by cubes.
const WIDE = 30;
// A bound on chance may be far below what anybody sets.
const LEAST_LOG10 = -60;

/** @param {Parameter} parameter @returns {{low: number, high: number, kind: "linear" | "log" | "cubic"}} */
function scaleOf({ low, high, unit, default: usual }) {
  const from = unit === "log10" ? Math.max(low, LEAST_LOG10) : low;
  if (from > 0 && high / from > WIDE) return { low: from, high, kind: "log" };
  if (from === 0 && Number(usual) > 0 && high / Number(usual) > WIDE) return { low: from, high, kind: "cubic" };
  return { low: from, high, kind: "linear" };
}

/**
 * Where a slider stands for a value, 0 … STEPS.
 * @param {Parameter} parameter
 * @param {number} value
 */
export function positionOf(parameter, value) {
  const { low, high, kind } = scaleOf(parameter);
  const share = kind === "log" ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  const moved = kind === "cubic" ? Math.cbrt(share) : share;
  return Math.round(STEPS * Math.min(Math.max(moved, 0), 1));
}

/**
 * The value that a slider's place stands for: round, as people set values.
 * @param {Parameter} parameter
 * @param {number} position
 */
export function valueAt(parameter, position) {
  const { low, high, kind } = scaleOf(parameter);
  const share = position / STEPS;
  if (share <= 0) return low;
  if (share >= 1) return high;
  const value = kind === "log" ? low * (high / low) ** share : low + (high - low) * (kind === "cubic" ? share ** 3 : share);
  return parameter.kind === "int" ? Math.round(value) : Number(value.toPrecision(3));
}

/**
 * What is wrong with a value; empty where nothing is.
 * @param {Parameter} parameter
 * @param {Value} value
 * @param {Values} values  of the others
 * @param {Parameter[]} all
 */
export function faultOf(parameter, value, values, all) {
  if (parameter.kind === "bool") return "";
  const [low, high] = boundsOf(parameter, values, all);
  const number = Number(value);
  if (!Number.isFinite(number)) return "A number, please.";
  if (parameter.kind === "int" && !Number.isInteger(number)) return "A whole number, please.";
  return number < low || number > high ? `From ${short(low)} to ${short(high)}.` : "";
}

/**
 * The range as it is while the others have their values.
 * @param {Parameter} parameter
 * @param {Values} values
 * @param {Parameter[]} all
 * @returns {[number, number]}
 */
export function boundsOf(parameter, values, all) {
  const bound = (/** @type {string | null} */ name, /** @type {number} */ fixed) => {
    const other = name && all.find((each) => each.name === inGroup(parameter, name));
    return other ? Number(values[other.name] ?? other.default) : fixed;
  };
  const own = /** @type {const} */ ([bound(parameter.not_below, parameter.low), bound(parameter.not_above, parameter.high)]);
  const valueOf = (/** @type {Parameter} */ each) => Number(values[each.name] ?? each.default);
  const namedIn = (/** @type {"not_below" | "not_above"} */ key) => all.filter((each) => each[key] && inGroup(each, each[key]) === parameter.name).map(valueOf);
  return [Math.max(own[0], ...namedIn("not_above")), Math.min(own[1], ...namedIn("not_below"))];
}

/** @param {Parameter} parameter @param {string} name */
const inGroup = ({ group }, name) => (group ? `${group}.${name}` : name);

/**
 * The values with one changed; a value that is its default is none.
 * @param {Values} values
 * @param {Parameter} parameter
 * @param {Value} value
 * @returns {Values}
 */
export function withValue(values, parameter, value) {
  const { [parameter.name]: _, ...rest } = values;
  return value === parameter.default ? rest : { ...rest, [parameter.name]: value };
}

/**
 * As the server takes them: `{"search": {"least_step": 0.4}}`.
 * @param {Values} values
 * @returns {Record<string, any>}
 */
export function nested(values) {
  /** @type {Record<string, any>} */
  const params = {};
  for (const [name, value] of Object.entries(values).sort(([a], [b]) => (a < b ? -1 : 1))) {
    const [group, own] = name.includes(".") ? name.split(".") : ["", name];
    if (group) params[group] = { ...params[group], [own]: value };
    else params[own] = value;
  }
  return params;
}

/**
 * The values that a server's object holds, without those that are defaults.
 * @param {Record<string, any>} params
 * @param {Parameter[]} all
 * @returns {Values}
 */
export function flat(params, all) {
  /** @type {Values} */
  let values = {};
  for (const parameter of all) {
    const own = parameter.name.split(".").reduce((held, key) => held?.[key], /** @type {any} */ (params));
    if (own !== undefined) values = withValue(values, parameter, own);
  }
  return values;
}

/** @param {Values} values @returns {string | null} for the address */
export const valuesToText = (values) =>
  Object.entries(values).map(([name, value]) => `${name}:${value}`).join("~") || null;

/**
 * A server's object for the address, before it is known what can be tuned.
 * @param {Record<string, any>} params
 * @returns {string | null}
 */
export const paramsToText = (params) =>
  valuesToText(Object.fromEntries(Object.entries(params).flatMap(([name, value]) =>
    typeof value === "object" && value !== null
      ? Object.entries(value).map(([own, inner]) => [`${name}.${own}`, inner])
      : [[name, value]])));

/**
 * @param {string | null} text
 * @param {Parameter[]} all  what else an address names is left out
 * @returns {Values}
 */
export function valuesFromText(text, all) {
  /** @type {Values} */
  let values = {};
  for (const part of (text ?? "").split("~")) {
    const [name, word = ""] = part.split(":");
    const parameter = all.find((each) => each.name === name);
    if (!parameter || !word) continue;
    const value = parameter.kind === "bool" ? word === "true" : Number(word);
    if (!faultOf(parameter, value, {}, [])) {
      values = withValue(values, parameter, value);
    }
  }
  return withoutFaults(values, all);
}

/**
 * Those values that can be set beside each other.
 * @param {Values} values
 * @param {Parameter[]} all
 * @returns {Values}
 */
export function withoutFaults(values, all) {
  const fine = all.filter((each) => each.name in values && !faultOf(each, values[each.name], values, all));
  const kept = Object.fromEntries(fine.map(({ name }) => [name, values[name]]));
  // A value may have been in order only beside one that is not.
  return fine.length === Object.keys(values).length ? values : withoutFaults(kept, all);
}

/**
 * The command that reads a frame in the same way.
 * @param {{pad: string, camera: string, method: string, source: string, values: Values}} reading  names of files
 */
export function commandLine({ pad, camera, method, source, values }) {
  const options = Object.entries(values).map(([name, value]) => ` --param ${name}=${value}`).join("");
  const how = method === "dense" ? "" : ` --method ${method}`;
  return `padstudio detect --pad ${quoted(pad)} --camera ${quoted(camera)}${how}${options} ${quoted(source)} -o poses.jsonl`;
}

/** @param {string} word */
const quoted = (word) => (/^[\w./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/**
 * Parameters of a method by the stage where a reader looks for them.
 * @param {Parameter[]} all
 * @param {string} method
 * @param {string[]} order  of the stages
 * @returns {{stage: string, items: Parameter[]}[]}
 */
export function byStage(all, method, order) {
  const mine = all.filter(({ methods }) => methods.includes(method));
  return order
    .map((stage) => ({ stage, items: mine.filter(({ stages }) => stages[0] === stage) }))
    .filter(({ items }) => items.length);
}

/** @param {number} value */
const short = (value) => String(Number(value.toPrecision(6)));

/** @param {string} name @returns {string} without its group, in words */
export const nameInWords = (name) => name.replace(/^.*\./, "").replaceAll("_", " ");

/**
 * What to ask before a preset takes another's name; empty where nothing would be lost.
 * @param {{name: string, method: string, params: Record<string, any>}} preset
 * @param {import("../../server/tuningApi.js").Preset[]} kept
 * @returns {string}
 */
export function replaceQuestion({ name, method, params }, kept) {
  const before = kept.find((each) => each.name === name);
  if (!before || (before.method === method && textOf(before.params) === textOf(params))) return "";
  const whose = before.method === method ? "with other values" : `for the method ${before.method}`;
  return `There is a preset “${name}” already, ${whose}. Replace it, for everybody who uses this server?`;
}

/** @param {unknown} value @returns {string} the same whatever the order of the keys */
const textOf = (value) =>
  JSON.stringify(value, (_key, each) =>
    each && typeof each === "object" ? Object.fromEntries(Object.entries(each).sort(([a], [b]) => a.localeCompare(b))) : each);
