/**
 * The pad as a coloured mesh of a chart in space: its real pattern, two triangles a cell.
 *
 * @typedef {import("../server/answers.js").PadFile} PadFile
 * @typedef {{size: [number, number], file: PadFile}} PadPicture  size in mm, with the margin
 */

/** Patches along a side; of more cells every n-th one's colour is taken. */
const MOST = 160;
const MARGIN = "rgb(245, 245, 245)";
/** Of a dark cell, and how much a full one adds; the print is read in daylight. */
const DARK = 30;
const FULL = 255;

/**
 * @param {PadPicture} pad
 * @returns {Record<string, any>[]} traces of Plotly
 */
export function padMeshes({ size, file }) {
  const layers = file.layers.map(({ channel, cell_mm: cell, codes }) => ({ channel, cell, codes }));
  const wide = Math.max(...layers.map(({ cell, codes }) => cell * (codes[0] ?? "").length));
  const high = Math.max(...layers.map(({ cell, codes }) => cell * codes.length));
  const finest = Math.min(...layers.map(({ cell }) => cell));
  const [columns, rows] = [wide, high].map((mm) => Math.max(1, Math.min(MOST, Math.round(mm / finest))));
  const most = Math.max(1, file.levels - 1);
  const colourAt = (/** @type {number} */ row, /** @type {number} */ column) => {
    const level = (/** @type {string} */ channel) => {
      const layer = layers.find((each) => each.channel === channel);
      if (!layer) return 0;
      const across = Math.floor(((column + 0.5) * wide) / columns / layer.cell);
      const down = Math.floor(((row + 0.5) * high) / rows / layer.cell);
      return parseInt(layer.codes[down]?.[across] ?? "0", 36) / most;
    };
    return `rgb(${["red", "green", "blue"].map((channel) => Math.round(DARK + (FULL - DARK) * level(channel))).join(",")})`;
  };
  const cells = mesh(columns, rows, wide, high, 0);
  const facecolor = Array.from({ length: rows * columns }, (_, at) => colourAt(Math.floor(at / columns), at % columns));
  const margin = mesh(1, 1, Math.max(size[0], wide), Math.max(size[1], high), -0.002);
  return [
    { ...margin, facecolor: [MARGIN, MARGIN] },
    { ...cells, facecolor: facecolor.flatMap((colour) => [colour, colour]) },
  ];
}

/**
 * A grid of patches about the pad's centre, two triangles each, row by row from the page's top left.
 * @param {number} columns
 * @param {number} rows
 * @param {number} wide  mm
 * @param {number} high
 * @param {number} z  metres
 */
function mesh(columns, rows, wide, high, z) {
  const x = [];
  const y = [];
  for (let row = 0; row <= rows; row += 1) {
    for (let column = 0; column <= columns; column += 1) {
      x.push((wide * (column / columns - 0.5)) / 1000);
      y.push((high * (0.5 - row / rows)) / 1000);
    }
  }
  /** @type {number[][]} */
  const corners = [[], [], []];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const first = row * (columns + 1) + column;
      const below = first + columns + 1;
      for (const triangle of [[first, first + 1, below], [first + 1, below + 1, below]]) {
        triangle.forEach((corner, at) => corners[at].push(corner));
      }
    }
  }
  const [i, j, k] = corners;
  const flat = { ambient: 1, diffuse: 0, specular: 0, fresnel: 0 };
  return { type: "mesh3d", x, y, z: x.map(() => z), i, j, k, hoverinfo: "skip", flatshading: true, lighting: flat };
}
