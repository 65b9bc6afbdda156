/**
 * A map of the picture in parts.
 *
 * @typedef {import("../calibrationLogic.js").MapCell} MapCell
 */

const SVG = "http://www.w3.org/2000/svg";

/**
 * @param {SVGElement} svg
 * @param {MapCell[]} cells
 * @param {{label: string, aspect: number}} about  aspect: width over height of the picture
 */
export function drawLensMap(svg, cells, { label, aspect }) {
  const columns = 1 + Math.max(...cells.map(({ x }) => x));
  const rows = 1 + Math.max(...cells.map(({ y }) => y));
  svg.setAttribute("viewBox", `0 0 ${columns} ${(columns / aspect).toFixed(4)}`);
  svg.setAttribute("aria-label", label);
  const height = columns / aspect / rows;
  svg.replaceChildren(...cells.map(({ x, y, opacity, title }) => {
    const rect = document.createElementNS(SVG, "rect");
    const place = { x, y: y * height, width: 1, height, "fill-opacity": opacity };
    for (const [name, value] of Object.entries(place)) rect.setAttribute(name, String(value));
    const tip = document.createElementNS(SVG, "title");
    tip.textContent = title;
    rect.append(tip);
    return rect;
  }));
}
