/**
 * The one way to draw charts: Plotly, loaded when the first is drawn, in the colours of the page.
 *
 * @typedef {{data: Record<string, any>[], layout: Record<string, any>}} Chart
 * @typedef {(name: string) => string} Colours  the colour of a CSS variable, such as `ink-2`
 * @typedef {(colour: Colours, width: number, height: number) => Chart} MakeChart  for a size in pixels
 */

/** Drawn by a chart that the page itself answers pointers and keys for. */
const STILL = { staticPlot: true };
const LIVELY = { displaylogo: false, doubleClick: "reset" };

/** @type {Promise<any> | null} */
let loading = null;
/** @type {Map<string, string>} */
const known = new Map();
document.addEventListener("themechange", () => known.clear());

/** @returns {Promise<any>} Plotly, from the address that the page names */
function plotly() {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = document.body.dataset.charts ?? "";
    script.addEventListener("load", () => resolve(/** @type {any} */ (window).Plotly));
    script.addEventListener("error", () => reject(new Error("The charts could not be loaded.")));
    document.head.append(script);
  });
  return loading;
}

/** @type {Colours} */
function colour(name) {
  let found = known.get(name);
  if (!found) {
    // A pair of colours, light and dark, is resolved only as a property that is one.
    const probe = document.createElement("span");
    document.body.append(probe);
    probe.style.color = `var(--${name})`;
    found = getComputedStyle(probe).color;
    probe.remove();
    known.set(name, found);
  }
  return found;
}

/**
 * A chart that follows the size of its place and the theme.
 * @param {HTMLElement} area
 * @param {{onFrame?: (frame: number) => void}} [events]  of points with a frame as `customdata`;
 *   without them the chart takes no pointer
 */
export function mountPlot(area, { onFrame } = {}) {
  /** @type {MakeChart | null} */
  let make = null;
  let queued = false;
  let drawn = false;
  /** @type {number | null} */
  let at = null;
  let marked = "";
  const line = Object.assign(document.createElement("span"), { className: "plot-cursor", hidden: true });

  /** Put the cursor where its value stands on the x axis of the chart as it was drawn. */
  function moveCursor() {
    const axis = /** @type {any} */ (area)._fullLayout?.xaxis;
    const place = at === null || !axis?.l2p ? NaN : axis.l2p(at);
    const isIn = place >= 0 && place <= axis?._length;
    line.hidden = !isIn;
    if (!isIn) return;
    if (line.parentElement !== area) area.append(line);
    const { t, h } = /** @type {any} */ (area)._fullLayout._size;
    Object.assign(line.style, { left: `${axis._offset + place}px`, top: `${t}px`, height: `${h}px` });
  }

  async function paint() {
    queued = false;
    const { clientWidth: width, clientHeight: height } = area;
    if (!make || !width || !height) return;
    const { data, layout } = make(colour, width, height);
    const library = await plotly();
    await library.react(area, data, { ...styled(layout, area), width, height }, onFrame ? LIVELY : STILL);
    moveCursor();
    if (drawn || !onFrame) return;
    drawn = true;
    /** @type {any} */ (area).on("plotly_relayout", moveCursor);
    /** @type {any} */ (area).on("plotly_click", (/** @type {any} */ event) => {
      const frame = event.points[0]?.customdata;
      if (Number.isFinite(frame)) onFrame(frame);
    });
  }

  function paintSoon() {
    if (queued) return;
    queued = true;
    requestAnimationFrame(() => paint().catch((error) => {
      area.textContent = error.message;
    }));
  }
  new ResizeObserver(paintSoon).observe(area);
  document.addEventListener("themechange", paintSoon);

  return {
    /** @param {MakeChart} next */
    show(next) {
      make = next;
      paintSoon();
    },
    /**
     * Move the points of a trace.
     * @param {{name: string, point: Record<"x" | "y" | "z", (number | null)[]>}} mark
     */
    mark({ name, point }) {
      const key = JSON.stringify(point);
      const traces = /** @type {any} */ (area).data ?? [];
      const trace = traces.findIndex((/** @type {any} */ each) => each.name === name);
      if (trace < 0 || key === marked) return;
      marked = key;
      const { x, y, z } = point;
      void plotly().then((library) => library.restyle(area, { x: [x], y: [y], z: [z] }, [trace]));
    },
    /** A line through the chart at a value of its x axis; null: none. @param {number | null} value */
    cursor(value) {
      if (value === at) return;
      at = value;
      moveCursor();
    },
  };
}

/** @param {Record<string, any>} layout @param {HTMLElement} area */
function styled(layout, area) {
  const line = colour("line");
  const axis = ({ title = "", ...rest } = {}) => ({
    title: { text: title }, gridcolor: line, zerolinecolor: line, linecolor: line, ...rest,
  });
  const axes = Object.keys(layout).filter((name) => /^[xy]axis\d?$/.test(name));
  return {
    paper_bgcolor: "transparent",
    plot_bgcolor: "transparent",
    font: { family: getComputedStyle(area).fontFamily, size: 12, color: colour("ink-2") },
    margin: { l: 56, r: 8, t: 8, b: 44 },
    modebar: { bgcolor: "transparent", color: colour("line-strong"), activecolor: colour("ink") },
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
    hoverlabel: { bgcolor: colour("surface"), bordercolor: line, font: { color: colour("ink") } },
    ...layout,
    ...Object.fromEntries(axes.map((name) => [name, axis(layout[name])])),
  };
}
