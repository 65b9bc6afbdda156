import { clockInWords, mountInWords, vehicleChart, vehicleInWords, vehicleLines } from "/static/js/flight/charts/vehicleChartLogic.js";
import { equal } from "./check.js";

const CLOCK = { is_flights: false, offset_s: 73.4131, sigma_s: 0.006, climb_correlation: 0.99, turn_correlation: 0.98, overlap_s: 20, reason: "" };
const MOUNT = {
  rotation: [], turned_deg: 90.04, lean_forward_deg: 1.25, lean_right_deg: -0.5, sigma_deg: [0.1, 0.1, 0.3],
  residual_deg: 0.52, undetermined: [],
};
const FIT = { slope: 1.05, slope_low: 1.04, slope_high: 1.06, offset_mm: 10, scatter_mm: 4, samples: 200, range_m: 3, verdict: "too_high" };
const VEHICLE = {
  kind: "ulog", clock: CLOCK, mount: MOUNT, mount_reason: "", fit: FIT, scale_error: { value: 0.05, low: 0.04, high: 0.06 },
  columns: {
    frame: [0, 1, 2], time_s: [0, 0.1, 0.2], pose_m: [2, 2.1, null], vehicle_m: [2.05, null, 2.2], residual_mm: [1, null, null],
    tilt_deg: [1, 2, null], heading_deg: [10, 11, null], vehicle_tilt_deg: [1.1, 2.1, null], vehicle_heading_deg: [null, null, null],
  },
};
const PALETTE = { height: "h", x: "x", y: "y", ink2: "i" };

export const tests = {
  "lines that hold nothing are left out, others break at gaps and lead to frames": () => {
    equal(vehicleLines(VEHICLE, "vehicle-attitude").map(([name]) => name), ["tilt_deg", "vehicle_tilt_deg", "heading_deg"]);
    const [poses, vehicle] = vehicleChart(VEHICLE, "vehicle-height", PALETTE).data;
    equal([poses.y, vehicle.y, vehicle.connectgaps], [[2, 2.1, null], [2.05, null, 2.2], false]);
    equal([poses.x, poses.customdata], [[0, 0.1, 0.2], [0, 1, 2]]);
    equal(vehicleLines({ ...VEHICLE, columns: {} }, "vehicle-height"), []);
  },
  "the clock is told with its uncertainty, or why it is not": () => {
    equal(clockInWords(VEHICLE), "The ULog is 73.413 s ahead of the flight (± 6 ms), told by the motion.");
    equal(clockInWords({ kind: "srt", clock: { ...CLOCK, is_flights: true } }), "The subtitles are on the flight's clock.");
    const untold = { ...VEHICLE, clock: { ...CLOCK, offset_s: null, reason: "it moved too little" } };
    equal(clockInWords(untold), "The ULog is on a clock that the motion does not tell: it moved too little.");
    equal(vehicleInWords(untold, "vehicle-height"), clockInWords(untold));
  },
  "the implied scale error stands beside the heights": () => {
    const words = vehicleInWords(VEHICLE, "vehicle-height");
    equal(words.includes("Implied scale error +5.0 % (95 %: +4.0 % to +6.0 %)."), true);
    equal(words.includes("Poses are 5"), true);
  },
  "the mounting is told, and what is not determined of it": () => {
    equal(mountInWords(VEHICLE), "Mounting: turned 90.0° to the right (± 0.3°), leaning 1.3° forward (± 0.1°) and −0.5° to the right (± 0.1°) from straight down; the attitudes differ by 0.5°.");
    const flat = { ...VEHICLE, mount: { ...MOUNT, sigma_deg: [0.1, 0.1, 104], undetermined: [[0, 0, 1]] } };
    equal(mountInWords(flat).includes("(not determined)"), true);
    equal(mountInWords(flat).endsWith("tell the mounting about the axis down."), true);
    equal(mountInWords({ mount: null, mount_reason: "the log holds no attitude" }), "No mounting: the log holds no attitude.");
  },
};
