/**
 * The figures of a flight as Plotly draws them, and what they mean.
 *
 * @typedef {import("./timelineLogic.js").Timeline} Timeline
 * @typedef {import("../server/answers.js").Trajectory} Trajectory
 * @typedef {import("../server/answers.js").HeightFit} HeightFit
 * @typedef {import("../server/answers.js").Figures} Figures
 *
 * @typedef {import("../shared/components/plot.js").Chart} Chart
 * @typedef {Record<"x" | "y" | "height" | "other" | "ok" | "line" | "ink" | "ink2" | "pad", string>
 *   & {stages: string[]}} Palette
 */

import { compact, length, number, percent } from "../shared/formatLogic.js";
import { stageName } from "./flightLogic.js";
import { padMeshes } from "./padSurfaceLogic.js";
import { countOf, failedOf } from "./timelineLogic.js";

const HERE = "This frame";
const metres = (/** @type {number | null} */ mm) => (mm === null ? null : mm / 1000);

/** @param {Trajectory} trajectory */
export const isTimed = ({ time_s: times }) => times.some((time) => time !== null);

/** Times where there are any, else frame numbers. @param {Trajectory} trajectory */
export const abscissa = ({ time_s: times, frame }) =>
  times.some((time) => time !== null)
    ? { values: times, title: "Time (s)" }
    : { values: frame, title: "Frame" };

/** Places of frames of which range and bearing alone can be used. @param {Trajectory} trajectory */
const bearingsOf = ({ quality = [] }) => quality.flatMap((each, place) => (each === "bearing" ? [place] : []));

/** A column without the figures that are too uncertain. @param {Trajectory} trajectory @param {"x_mm" | "y_mm" | "z_mm"} column */
const trusted = ({ quality = [], ...columns }, column) =>
  columns[column].map((mm, place) => (quality[place] === "bearing" ? null : mm));

/**
 * The range where it is all that is known of the distance: hollow points, none where there are no such frames.
 * @param {Trajectory} trajectory
 * @param {number[]} places
 * @param {Palette} palette
 */
function rangeTrace(trajectory, places, palette) {
  if (!places.length) return [];
  const { x_mm: x, y_mm: y, z_mm: z, frame } = trajectory;
  return [{
    type: "scatter", mode: "markers", name: "Range (bearing only)",
    x: places.map((place) => abscissa(trajectory).values[place]),
    y: places.map((place) => metres(Math.hypot(x[place] ?? 0, y[place] ?? 0, z[place] ?? 0))),
    customdata: places.map((place) => frame[place]),
    marker: { color: palette.height, symbol: "circle-open", size: 5 },
    hovertemplate: "%{y:.3f} m away<extra>range and bearing only, frame %{customdata}</extra>",
  }];
}

/**
 * What the trajectory leaves out; empty where nothing.
 * @param {Figures} figures
 * @returns {string}
 */
export function trajectoryInWords({ trajectory }) {
  const count = bearingsOf(trajectory).length;
  if (!count) return "";
  const frames = count === 1 ? "1 frame shows" : `${number(count)} frames show`;
  return `${frames} range and bearing only: hollow points at the range, as the place is too uncertain.`;
}

/**
 * Height and both horizontal coordinates over time.
 * @param {Figures} figures
 * @param {Figures | null} other  of a second run
 * @param {Palette} palette
 * @returns {Chart}
 */
export function trajectoryChart(figures, other, palette) {
  const bearings = bearingsOf(figures.trajectory);
  const { title } = abscissa(figures.trajectory);
  /** @type {["x_mm" | "y_mm" | "z_mm", string, string][]} */
  const lines = [
    ["z_mm", "Height", palette.height],
    ["x_mm", "X", palette.x],
    ["y_mm", "Y", palette.y],
  ];
  const traces = (/** @type {Figures} */ { trajectory }, /** @type {boolean} */ isOther) =>
    lines.map(([column, name, colour]) => ({
      type: "scatter",
      mode: isOther ? "lines" : "lines+markers",
      name: isOther ? `${name}, other run` : name,
      x: abscissa(trajectory).values,
      y: trusted(trajectory, column).map(metres),
      customdata: trajectory.frame,
      connectgaps: false,
      line: { color: colour, width: isOther ? 1 : 1.5, dash: isOther ? "dot" : "solid" },
      marker: { color: colour, size: 3 },
      hovertemplate: `%{y:.3f} m<extra>${name}, frame %{customdata}</extra>`,
    }));
  return {
    data: [...(other ? traces(other, true) : []), ...traces(figures, false), ...rangeTrace(figures.trajectory, bearings, palette)],
    layout: { hovermode: "x unified", xaxis: { title, unifiedhovertitle: { text: isTimed(figures.trajectory) ? "%{x:.2f} s" : "frame %{x}" } }, yaxis: { title: "Metres in the pad frame" } },
  };
}

/**
 * Poses in space: the pad, the way, and numbered cones that open to where the camera looks.
 * @param {Figures} figures
 * @param {import("./padSurfaceLogic.js").PadPicture | null} pad
 * @param {Palette} palette
 * @returns {Chart}
 */
export function spaceChart({ trajectory, samples }, pad, palette) {
  const found = samples.filter((sample) => sample.position_mm && sample.axis && sample.quality !== "bearing");
  const at = (/** @type {0 | 1 | 2} */ axis) =>
    found.map(({ position_mm: position }) => /** @type {number[]} */ (position)[axis] / 1000);
  const heights = trusted(trajectory, "z_mm").flatMap((mm) => (mm === null ? [] : [mm / 1000]));
  const cone = 0.07 * Math.max(...heights, 0.2);
  // A cone's tip stands where the camera is, its base faces what the camera sees.
  const along = (/** @type {0 | 1 | 2} */ axis) =>
    found.map((sample) => -cone * /** @type {number[]} */ (sample.axis)[axis]);
  const text = found.map((sample) => String(sample.number));
  const frames = found.map((sample) => sample.frame);
  const places = found.map(({ frame, position_mm: position }) => {
    const [x, y, z] = /** @type {number[]} */ (position).map((mm) => number(mm / 1000, 3));
    return `frame ${frame}<br>X ${x} m, Y ${y} m, height ${z} m`;
  });
  const data = [
    {
      type: "scatter3d", mode: "lines", name: "Way", hoverinfo: "skip", connectgaps: false,
      x: trusted(trajectory, "x_mm").map(metres), y: trusted(trajectory, "y_mm").map(metres),
      z: trusted(trajectory, "z_mm").map(metres),
      line: { color: palette.other, width: 2 },
    },
    {
      type: "cone", anchor: "tip", sizemode: "raw", sizeref: 1, showscale: false, hoverinfo: "skip",
      x: at(0), y: at(1), z: at(2), u: along(0), v: along(1), w: along(2),
      colorscale: [[0, palette.height], [1, palette.height]],
    },
    {
      type: "scatter3d", mode: "text", name: "Pose", text, hovertext: places, customdata: frames,
      x: at(0), y: at(1), z: at(2).map((z) => z + cone / 3), textfont: { size: 12, color: palette.ink },
      hovertemplate: "%{text}: %{hovertext}<extra></extra>",
    },
  ];
  return {
    data: [...data, here(palette), ...(pad ? padMeshes(pad) : [])],
    layout: { scene: scene(palette, distanceFor(trajectory, pad?.size ?? null)), showlegend: false, margin: { l: 0, r: 0, t: 0, b: 0 } },
  };
}

/** The frame that is looked at; `markIn` says where it stands. @param {Palette} palette */
const here = (palette) => ({
  type: "scatter3d", mode: "markers", name: HERE, x: [null], y: [null], z: [null], hoverinfo: "skip",
  marker: { size: 7, symbol: "diamond", color: palette.ink },
});

/**
 * Where the mark of the frame that is looked at stands in the chart of poses in space.
 * @param {Figures} figures
 * @param {number | null} frame
 * @returns {{name: string, point: Record<"x" | "y" | "z", (number | null)[]>}}
 */
export function markIn({ trajectory }, frame) {
  const { frame: frames } = trajectory;
  const wanted = frame ?? -1;
  // Of a long flight only some frames are there: the nearest one.
  const place = frames.reduce((best, each, at) =>
    (Math.abs(each - wanted) < Math.abs(frames[best] - wanted) ? at : best), 0);
  const at = (/** @type {"x_mm" | "y_mm" | "z_mm"} */ column) =>
    [frame === null ? null : metres(trusted(trajectory, column)[place] ?? null)];
  return { name: HERE, point: { x: at("x_mm"), y: at("y_mm"), z: at("z_mm") } };
}

/**
 * How far off all of a flight is in view; a high and narrow one needs more distance.
 * @param {Trajectory} trajectory
 * @param {[number, number] | null} padSize  mm
 * @returns {number} 1 for a flight as high as it is wide
 */
function distanceFor({ x_mm: x, y_mm: y, z_mm: z }, padSize) {
  const extent = (/** @type {(number | null)[]} */ values, least = 1) => {
    const known = values.filter((value) => value !== null);
    return Math.max(known.length ? Math.max(...known) - Math.min(...known) : 0, least);
  };
  const wide = Math.max(extent(x, padSize?.[0]), extent(y, padSize?.[1]));
  // Plotly keeps the volume of the scene, so that its height grows so with its proportions.
  return Math.max(1, 0.65 * (extent([...z, 0]) / wide) ** (2 / 3));
}

/** @param {Palette} palette @param {number} distance */
function scene(palette, distance) {
  const axis = (/** @type {string} */ title) => ({
    title: { text: title }, color: palette.ink2, gridcolor: palette.line, showbackground: false,
    zerolinecolor: palette.line,
  });
  return {
    aspectmode: "data",
    xaxis: axis("X (m)"),
    yaxis: axis("Y (m)"),
    zaxis: { ...axis("Height (m)"), rangemode: "tozero" },
    camera: {
      eye: { x: 1.55 * distance, y: -1.75 * distance, z: 0.65 * distance },
      center: { x: 0, y: 0, z: -0.1 },
    },
  };
}

/**
 * The numbers that are missing among the cones.
 * @param {Figures["samples"]} samples
 * @returns {string}
 */
export function samplesInWords(samples) {
  const numbers = (/** @type {Figures["samples"]} */ some) => some.map((sample) => sample.number);
  const missing = numbers(samples.filter((sample) => !sample.position_mm));
  const bearing = numbers(samples.filter((sample) => sample.quality === "bearing"));
  const every = `${number(samples.length)} frames at equal distances`;
  if (!missing.length && !bearing.length) return `${every}, all with a pose.`;
  const parts = /** @type {[number[], string][]} */ ([[missing, "no pose"], [bearing, "range and bearing only"]])
    .filter(([some]) => some.length)
    .map(([some, why]) => `${some.join(", ")} ${some.length === 1 ? "is" : "are"} missing: ${why}`);
  return `${every}; ${parts.join("; ")}.`;
}

/** The middle of each column, s or frame. @param {Timeline} timeline */
function columnPlaces({ columns, first_frame: first, frames_per_column: width }) {
  const timed = columns.every((column) => column.time_s !== null);
  return {
    title: timed ? "Time (s)" : "Frame",
    x: columns.map((column) => (timed ? column.time_s : first + column.column * width)),
  };
}

/**
 * The share of frames with a pose, over time.
 * @param {Timeline} timeline
 * @param {Timeline | null} other
 * @param {Palette} palette
 * @returns {Chart}
 */
export function outcomesChart(timeline, other, palette) {
  const trace = (/** @type {Timeline} */ run, /** @type {boolean} */ isOther) => ({
    type: "scatter",
    mode: "lines",
    name: isOther ? "Other run" : "This run",
    x: columnPlaces(run).x,
    y: run.columns.map((column) => (100 * (countOf(column) - failedOf(column))) / countOf(column)),
    customdata: run.columns.map((column) => column.first_frame),
    line: { color: isOther ? palette.other : palette.ok, shape: "hv", dash: isOther ? "dot" : "solid" },
    ...(isOther ? {} : { fill: "tozeroy" }),
    hovertemplate: "%{y:.1f} % with a pose, from frame %{customdata}<extra></extra>",
  });
  return {
    data: [trace(timeline, false), ...(other ? [trace(other, true)] : [])],
    layout: {
      xaxis: { title: columnPlaces(timeline).title },
      yaxis: { title: "Frames with a pose (%)", range: [0, 104] },
      showlegend: Boolean(other),
    },
  };
}

/**
 * The first failing stage over time, as stacked bars.
 * @param {Timeline} timeline
 * @param {Palette} palette
 * @returns {Chart}
 */
export function stagesChart(timeline, palette) {
  const { x, title } = columnPlaces(timeline);
  const stages = [...new Set(timeline.columns.flatMap((column) => Object.keys(column.stages)))].sort();
  const data = stages.map((stage, at) => ({
    type: "bar",
    name: stageName(stage),
    x,
    y: timeline.columns.map((column) => column.stages[stage] ?? 0),
    customdata: timeline.columns.map((column) => column.first_frame),
    marker: { color: palette.stages[at % palette.stages.length] },
    hovertemplate: "%{y} frames, from frame %{customdata}<extra>%{fullData.name}</extra>",
  }));
  return {
    data,
    layout: { barmode: "stack", bargap: 0, xaxis: { title }, yaxis: { title: "Frames without a pose" }, showlegend: true },
  };
}

/**
 * Pose height against telemetry height, with the fitted line and the one that both would agree on.
 * @param {NonNullable<Figures["heights"]>} heights
 * @param {Palette} palette
 * @returns {Chart}
 */
export function heightsChart({ frame, telemetry_m: telemetry, pose_mm: pose, fit }, palette) {
  /** @type {Record<string, any>[]} */
  const data = [{
    type: "scatter", mode: "markers", name: "Frames", x: telemetry, y: pose.map(metres), customdata: frame,
    marker: { color: palette.height, size: 4, opacity: 0.6 },
    hovertemplate: "telemetry %{x:.2f} m, pose %{y:.3f} m<extra>frame %{customdata}</extra>",
  }];
  if (fit) {
    const ends = [Math.min(...telemetry), Math.max(...telemetry)];
    const middle = (ends[0] + ends[1]) / 2;
    const at = (/** @type {number} */ x) => fit.slope * x + fit.offset_mm / 1000;
    data.push(
      { type: "scatter", mode: "lines", name: `Slope ${number(fit.slope, 3)}`, x: ends, y: ends.map(at),
        line: { color: palette.x, width: 2 }, hoverinfo: "skip" },
      { type: "scatter", mode: "lines", name: "Slope 1", x: ends, y: ends.map((x) => at(middle) + x - middle),
        line: { color: palette.other, width: 1, dash: "dot" }, hoverinfo: "skip" },
    );
  }
  return {
    data,
    layout: { xaxis: { title: "Telemetry height (m)" }, yaxis: { title: "Pose height (m)" }, showlegend: true },
  };
}

/**
 * What the slope says of the print and of the camera.
 * @param {Figures["heights"]} heights
 * @returns {string}
 */
export function heightsInWords(heights) {
  const fit = heights?.fit;
  if (!heights) return "";
  if (!fit) return "Too few heights to compare.";
  const { slope, slope_low: low, slope_high: high, verdict } = fit;
  const figures = `Slope ${number(slope, 3)} (95 %: ${number(low, 3)} to ${number(high, 3)}), ` +
    `offset ${length(fit.offset_mm)}, scatter ${length(fit.scatter_mm)}.`;
  if (verdict === "uncertain") {
    return `${figures} The telemetry covers ${compact(fit.range_m, 1)} m with ${number(fit.samples)} frames: ` +
      "too little to judge the print or the camera by.";
  }
  if (verdict === "agrees") return `${figures} Poses and telemetry agree: print scale and focal length are right.`;
  const off = percent(Math.abs(slope - 1), 1);
  const way = verdict === "too_high" ? ["high", "smaller", "long"] : ["low", "larger", "short"];
  return `${figures} Poses are ${off} too ${way[0]}. Either the print is ${way[1]} than its file says, at ` +
    `${percent(1 / slope, 1)} of its size: measure a long row of cells. Or the camera file's focal length is ` +
    `too ${way[2]}: the true one is ${number(1 / slope, 3)} times as long. Calibrate the camera.`;
}
