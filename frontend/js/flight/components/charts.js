/**
 * The figures of a flight; Plotly is loaded when they come into view, and not before.
 *
 * @typedef {import("../figuresLogic.js").Figures} Figures
 * @typedef {import("../figuresLogic.js").Chart} Chart
 * @typedef {import("../timelineLogic.js").Timeline} Timeline
 *
 * @typedef {object} ChartState
 * @property {Figures | null} figures
 * @property {Figures | null} otherFigures  of a second run
 * @property {Timeline | null} coarse  the whole flight in few columns
 * @property {Timeline | null} otherCoarse
 * @property {[number, number] | null} padSize  mm
 */

import * as logic from "../figuresLogic.js";

const CONFIG = { displaylogo: false, responsive: true, doubleClick: "reset" };

/**
 * @param {HTMLElement} root  whose `data-script` is Plotly's address
 * @param {{onSeek: (frame: number) => void, onVisible: () => void}} events
 */
export function mountCharts(root, { onSeek, onVisible }) {
  const find = (/** @type {string} */ name) =>
    /** @type {HTMLElement} */ (root.querySelector(`[data-ref="${name}"]`));
  /** @type {Promise<any> | null} */
  let loading = null;
  /** @type {ChartState | null} */
  let state = null;
  let visible = false;
  let drawn = "";

  /** @returns {Promise<any>} Plotly */
  function plotly() {
    loading ??= new Promise((resolve, reject) => {
      const script = document.createElement("script");
      script.src = root.dataset.script ?? "";
      script.addEventListener("load", () => resolve(/** @type {any} */ (window).Plotly));
      script.addEventListener("error", () => reject(new Error("The charts could not be loaded.")));
      document.head.append(script);
    });
    return loading;
  }

  /** @param {string} name @param {Chart | null} chart @param {string} note */
  async function show(name, chart, note) {
    const area = find(name);
    const figure = /** @type {HTMLElement} */ (area.closest(".chart"));
    figure.hidden = !chart?.data.length;
    find(`${name}-note`).textContent = note;
    if (!chart?.data.length) return;
    const isNew = !area.hasAttribute("data-drawn");
    await (await plotly()).react(area, chart.data, styled(chart.layout, root), CONFIG);
    area.dataset.drawn = "true";
    if (isNew) {
      /** @type {any} */ (area).on("plotly_click", (/** @type {any} */ event) => {
        const frame = event.points[0]?.customdata;
        if (Number.isFinite(frame)) onSeek(frame);
      });
    }
  }

  async function draw() {
    if (!visible || !state?.figures || !state.coarse) return;
    const key = JSON.stringify([state, getComputedStyle(root).color]);
    if (key === drawn) return;
    drawn = key;
    const { figures, otherFigures, coarse, otherCoarse, padSize } = state;
    const palette = paletteOf(root);
    const { heights } = figures;
    find("message").textContent = loading ? "" : "Loading the charts …";
    try {
      await plotly();
      find("message").textContent = "";
      await show("trajectory", logic.trajectoryChart(figures, otherFigures, palette), "");
      await show("outcomes", logic.outcomesChart(coarse, otherCoarse, palette), "");
      await show("stages", logic.stagesChart(coarse, palette), "");
      await show("heights", heights && logic.heightsChart(heights, palette), logic.heightsInWords(heights));
      await show("space", logic.spaceChart(figures, padSize, palette), logic.samplesInWords(figures.samples));
    } catch (error) {
      find("message").textContent = /** @type {Error} */ (error).message;
    }
  }

  new IntersectionObserver((entries) => {
    visible = entries.some((entry) => entry.isIntersecting);
    if (!visible) return;
    onVisible();
    void draw();
  }, { rootMargin: "300px" }).observe(root);
  document.addEventListener("themechange", () => void draw());

  return {
    /** @param {ChartState & {enabled: boolean}} next */
    update({ enabled, ...next }) {
      root.hidden = !enabled;
      state = next;
      void draw();
    },
  };
}

/** @param {Record<string, any>} layout @param {HTMLElement} root */
function styled(layout, root) {
  const palette = paletteOf(root);
  const axis = (/** @type {any} */ { title = "", ...rest } = {}) => ({
    title: { text: title }, gridcolor: palette.line, zerolinecolor: palette.line, linecolor: palette.line, ...rest,
  });
  return {
    paper_bgcolor: "transparent",
    plot_bgcolor: "transparent",
    font: { family: getComputedStyle(root).fontFamily, size: 12, color: palette.ink2 },
    margin: { l: 56, r: 8, t: 8, b: 44 },
    modebar: { bgcolor: "transparent", color: palette.other, activecolor: palette.ink },
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
    hoverlabel: { bgcolor: palette.surface, bordercolor: palette.line, font: { color: palette.ink } },
    ...layout,
    ...(layout.scene ? {} : { xaxis: axis(layout.xaxis), yaxis: axis(layout.yaxis) }),
  };
}

/** @param {HTMLElement} root @returns {logic.Palette} */
function paletteOf(root) {
  const probe = document.createElement("span");
  root.append(probe);
  const colour = (/** @type {string} */ name) => {
    probe.style.color = `var(--${name})`;
    return getComputedStyle(probe).color;
  };
  const found = {
    x: colour("series-1"), y: colour("series-2"), height: colour("series-3"), other: colour("line-strong"),
    ok: colour("accent"), line: colour("line"), ink: colour("ink"), ink2: colour("ink-2"),
    surface: colour("surface"), pad: colour("line-strong"),
    stages: ["series-1", "series-2", "series-3", "series-4", "series-5", "series-6"].map(colour),
  };
  probe.remove();
  return found;
}
