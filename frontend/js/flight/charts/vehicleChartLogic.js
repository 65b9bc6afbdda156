/**
 * The vehicle's log beside the poses: charts over time, and what they say in words.
 *
 * @typedef {import("../../server/answers.js").VehicleComparison} VehicleComparison
 * @typedef {import("../figuresLogic.js").Palette} Palette
 * @typedef {import("../../shared/components/plot.js").Chart} Chart
 */

import { heightsInWords } from "../figuresLogic.js";
import { compact, number } from "../../shared/formatLogic.js";

const LOGS = /** @type {Record<string, string>} */ ({
  srt: "The subtitles are", csv: "The table is", ulog: "The ULog is", dataflash: "The DataFlash log is", tlog: "The MAVLink log is",
});
/** Beyond this many degrees an axis counts as not determined. */
const UNKNOWN_DEG = 90;
const AXES = ["forward", "right", "down"];

/** @type {Record<string, {title: string, lines: [string, string, string][]}>} */
export const VEHICLE_CHARTS = {
  "vehicle-height": { title: "Height (m)", lines: [["pose_m", "Poses", " m"], ["vehicle_m", "Vehicle", " m"]] },
  "vehicle-attitude": {
    title: "Degrees",
    lines: [
      ["tilt_deg", "Tilt, poses", "°"], ["vehicle_tilt_deg", "Tilt, vehicle", "°"],
      ["heading_deg", "Heading, poses", "°"], ["vehicle_heading_deg", "Heading, vehicle", "°"],
    ],
  },
  "vehicle-residual": {
    title: "Residual: mm, degrees",
    lines: [["residual_mm", "Height, mm", " mm"], ["attitude_residual_deg", "Attitude, °", "°"]],
  },
};

/**
 * The lines of a chart that hold anything.
 * @param {VehicleComparison} vehicle
 * @param {string} chart
 */
export const vehicleLines = ({ columns }, chart) =>
  VEHICLE_CHARTS[chart].lines.filter(([name]) => columns[name]?.some((value) => value !== null));

/**
 * @param {VehicleComparison} vehicle
 * @param {string} chart
 * @param {Palette} palette
 * @returns {Chart}
 */
export function vehicleChart(vehicle, chart, palette) {
  const colours = [palette.height, palette.x, palette.y, palette.ink2];
  const data = vehicleLines(vehicle, chart).map(([name, words, unit], at) => ({
    type: "scatter", mode: "lines", name: words,
    x: vehicle.columns.time_s, y: vehicle.columns[name], customdata: vehicle.columns.frame,
    connectgaps: false,
    line: { color: colours[at], width: 1.5, dash: at % 2 && chart !== "vehicle-residual" ? "dot" : "solid" },
    hovertemplate: `%{y:.4~g}${unit}<extra>${words}, frame %{customdata}</extra>`,
  }));
  const { title } = VEHICLE_CHARTS[chart];
  return { data, layout: { xaxis: { title: "Time (s)" }, yaxis: { title }, showlegend: true } };
}

/**
 * What stands beside a chart.
 * @param {VehicleComparison} vehicle
 * @param {string} chart
 * @returns {string}
 */
export function vehicleInWords(vehicle, chart) {
  if (chart === "vehicle-attitude") return mountInWords(vehicle);
  if (chart === "vehicle-residual") return "What clock, mounting and the heights' fitted line leave.";
  const { fit } = vehicle;
  const heights = fit ? heightsInWords({ frame: [], telemetry_m: [], pose_mm: [], fit }) : "No heights to compare.";
  return vehicle.clock.offset_s === null ? clockInWords(vehicle) : `${clockInWords(vehicle)} ${errorInWords(vehicle)}${heights}`;
}

/** @param {VehicleComparison} vehicle @returns {string} */
export function clockInWords({ kind, clock }) {
  const log = LOGS[kind] ?? "The log is";
  if (clock.is_flights) return `${log} on the flight's clock.`;
  if (clock.offset_s === null) return `${log} on a clock that the motion does not tell: ${clock.reason}.`;
  return `${log} ${compact(clock.offset_s, 3)} s ahead of the flight (± ${number((clock.sigma_s ?? 0) * 1000, 0)} ms), told by the motion.`;
}

/** @param {VehicleComparison} vehicle @returns {string} */
function errorInWords({ scale_error: error }) {
  if (!error) return "";
  const signed = (/** @type {number} */ share) => `${share < 0 ? "−" : "+"}${number(100 * Math.abs(share), 1)} %`;
  return `Implied scale error ${signed(error.value)} (95 %: ${signed(error.low)} to ${signed(error.high)}). `;
}

/**
 * How the camera sits on the vehicle.
 * @param {VehicleComparison} vehicle
 * @returns {string}
 */
export function mountInWords({ mount, mount_reason: reason }) {
  if (!mount) return reason ? `No mounting: ${reason}.` : "";
  const sure = (/** @type {number} */ axis) => (mount.sigma_deg[axis] > UNKNOWN_DEG ? "not determined" : `± ${number(mount.sigma_deg[axis], 1)}°`);
  const open = AXES.filter((_, axis) => mount.sigma_deg[axis] > UNKNOWN_DEG);
  const told = `Mounting: turned ${number(mount.turned_deg, 1)}° to the right (${sure(2)}), leaning ` +
    `${number(mount.lean_forward_deg, 1)}° forward (${sure(1)}) and ${number(mount.lean_right_deg, 1)}° to the right (${sure(0)}) ` +
    `from straight down; the attitudes differ by ${number(mount.residual_deg, 1)}°.`;
  if (!mount.undetermined.length) return told;
  const about = mount.undetermined.length > 1 ? "any axis" : open.length === 1 ? `the axis ${open[0]}` : "one axis";
  return `${told} The vehicle turned too little to tell the mounting about ${about}.`;
}
