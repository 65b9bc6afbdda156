/**
 * A pad as the page draws it, from the codes of a pad file.
 *
 * @typedef {import("../server/answers.js").Channel} Channel
 * @typedef {import("../server/answers.js").PadFile} PadFile
 *
 * @typedef {object} LayerView
 * @property {Channel} channel
 * @property {number} rows
 * @property {number} cols
 * @property {number} cellMm
 * @property {Uint8Array} levels  row by row
 *
 * @typedef {object} PadView
 * @property {string} name
 * @property {number} window
 * @property {number} levels
 * @property {number} quietMm
 * @property {number} widthMm  without the quiet margin
 * @property {number} heightMm
 * @property {LayerView[]} layers
 *
 * @typedef {object} CellPlace
 * @property {LayerView} layer
 * @property {number} row
 * @property {number} col
 * @property {number} level
 */

/**
 * @param {PadFile} file
 * @returns {PadView}
 */
export function viewOfPad(file) {
  const layers = file.layers.map((layer) => ({
    channel: layer.channel,
    rows: layer.codes.length,
    cols: layer.codes[0].length,
    cellMm: layer.cell_mm,
    levels: levelsOf(layer.codes),
  }));
  return {
    name: file.name,
    window: file.window,
    levels: file.levels,
    quietMm: file.quiet_mm ?? 0,
    ...extentOf(layers),
    layers,
  };
}

/**
 * @param {string[]} codes  rows of base-36 digits
 * @returns {Uint8Array}
 */
function levelsOf(codes) {
  const levels = new Uint8Array(codes.length * codes[0].length);
  let place = 0;
  for (const row of codes) {
    for (let at = 0; at < row.length; at += 1) {
      // "0" is 48, "a" is 97: a loop over a million cells that a drag waits for.
      const code = row.charCodeAt(at);
      levels[place++] = code < 58 ? code - 48 : (code | 32) - 87;
    }
  }
  return levels;
}

/**
 * A pad file of the same code at another size.
 * @param {PadFile} file
 * @param {{name: string, cell_mm: number, quiet_mm: number}} sizes  the side of the finest cell
 * @returns {PadFile}  of a print that nobody measured yet
 */
export function resizedFile(file, { name, cell_mm, quiet_mm }) {
  const finest = Math.min(...file.layers.map((layer) => layer.cell_mm));
  const layers = file.layers.map((layer) => {
    const ratio = layer.cell_mm / finest;
    const whole = Math.round(ratio);
    // Fractions such as 2.1 / 0.7 are not whole in the computer.
    return { ...layer, cell_mm: (Math.abs(ratio - whole) < 1e-9 ? whole : ratio) * cell_mm };
  });
  const { scale, crosstalk, ...kept } = /** @type {PadFile & Record<string, unknown>} */ (file);
  return { ...kept, name, quiet_mm, layers };
}

/**
 * What is drawn of the resized file, without reading its codes again.
 * @param {PadView} pad
 * @param {PadFile} file  from `resizedFile`
 * @returns {PadView}
 */
export function resizedView(pad, file) {
  const layers = pad.layers.map((layer, place) => ({ ...layer, cellMm: file.layers[place].cell_mm }));
  return { ...pad, name: file.name, quietMm: file.quiet_mm ?? 0, layers, ...extentOf(layers) };
}

/** @param {LayerView[]} layers @returns {{widthMm: number, heightMm: number}} */
const extentOf = (layers) => ({
  widthMm: Math.max(...layers.map((layer) => layer.cols * layer.cellMm)),
  heightMm: Math.max(...layers.map((layer) => layer.rows * layer.cellMm)),
});

/**
 * RGBA pixels of one layer, one pixel a cell; the other channels are dark.
 * @param {LayerView} layer
 * @param {number} levels  Y of the pad
 * @returns {Uint8ClampedArray<ArrayBuffer>}
 */
export function layerPixels(layer, levels) {
  const pixels = new Uint8ClampedArray(layer.levels.length * 4);
  const offset = { red: 0, green: 1, blue: 2 }[layer.channel];
  layer.levels.forEach((level, place) => {
    pixels[4 * place + offset] = Math.round((level * 255) / (levels - 1));
    pixels[4 * place + 3] = 255;
  });
  return pixels;
}

/**
 * The layers that a view shows, the finest first.
 * @param {PadView} pad
 * @param {string} view  "print" or a channel
 * @returns {LayerView[]}
 */
export function layersOfView(pad, view) {
  const shown = view === "print" ? pad.layers : pad.layers.filter((l) => l.channel === view);
  return [...shown].sort((a, b) => a.cellMm - b.cellMm);
}

/**
 * The cell at a place on the page.
 * @param {LayerView} layer
 * @param {number} x  mm from the pad's left edge
 * @param {number} y  mm from the pad's top edge
 * @param {PadView} pad
 * @returns {CellPlace | null}
 */
export function cellAt(layer, x, y, pad) {
  const col = Math.floor((x - pad.quietMm) / layer.cellMm);
  const row = Math.floor((y - pad.quietMm) / layer.cellMm);
  if (col < 0 || row < 0 || col >= layer.cols || row >= layer.rows) return null;
  return { layer, row, col, level: layer.levels[row * layer.cols + col] };
}

/**
 * The top-left cell of the b × b window round a cell, moved inside the layer at its borders.
 * @param {CellPlace} cell
 * @param {number} b
 * @returns {{row: number, col: number}}
 */
export function windowRound(cell, b) {
  const start = (/** @type {number} */ at, /** @type {number} */ count) =>
    Math.max(0, Math.min(at - Math.floor((b - 1) / 2), count - b));
  return { row: start(cell.row, cell.layer.rows), col: start(cell.col, cell.layer.cols) };
}

/**
 * A window's code: the base-Y number of its cells, row by row.
 * @param {LayerView} layer
 * @param {number} row
 * @param {number} col
 * @param {number} b
 * @param {number} levels
 * @returns {bigint}
 */
export function windowCode(layer, row, col, b, levels) {
  let code = 0n;
  for (let r = row; r < row + b; r += 1) {
    for (let c = col; c < col + b; c += 1) {
      code = code * BigInt(levels) + BigInt(layer.levels[r * layer.cols + c]);
    }
  }
  return code;
}

/**
 * Where a place on the page lies in the pad frame: origin at the pad's centre, Y up.
 * @param {PadView} pad
 * @param {number} x  page mm, quiet margin included
 * @param {number} y
 * @returns {{x: number, y: number}}  mm
 */
export function padFrame(pad, x, y) {
  return { x: x - pad.quietMm - pad.widthMm / 2, y: pad.heightMm / 2 - (y - pad.quietMm) };
}

/** @type {WeakMap<Uint8Array, number[]>} */
const counted = new WeakMap();

/**
 * Share of cells at each level; counted once, as every change of the page asks for it.
 * @param {LayerView} layer
 * @param {number} levels
 * @returns {number[]}
 */
export function levelShares(layer, levels) {
  let shares = counted.get(layer.levels);
  if (!shares) {
    const counts = new Array(levels).fill(0);
    for (const level of layer.levels) counts[level] += 1;
    shares = counts.map((count) => count / layer.levels.length);
    counted.set(layer.levels, shares);
  }
  return shares;
}
