/**
 * The report of an experiment: words, claims, figures and tables, of whatever kind it is.
 *
 * @typedef {import("../../server/experimentsApi.js").Claim} Claim
 * @typedef {import("../../server/experimentsApi.js").ExperimentDetail} ExperimentDetail
 * @typedef {import("../../server/experimentsApi.js").ReportFigure} ReportFigure
 * @typedef {import("../../server/experimentsApi.js").ReportSection} ReportSection
 * @typedef {import("../../server/experimentsApi.js").ReportTable} ReportTable
 */

import { experimentFileUrl } from "../../server/experimentsApi.js";
import { fileInWords, sortedFiles, verdictKind } from "../experimentLogic.js";

/** @param {HTMLElement} root */
export function mountReportView(root) {
  let shown = "";
  return {
    /** @param {ExperimentDetail | null} experiment */
    update(experiment) {
      root.hidden = !experiment?.result;
      if (!experiment?.result || shown === experiment.id) return;
      shown = experiment.id;
      const { id, files, result } = experiment;
      root.replaceChildren(
        element("h3", result.title),
        filesOf(id, experiment.files),
        ...result.words.map((words) => element("p", words)),
        ...result.sections.flatMap((section) => sectionOf(id, section)),
      );
      root.dataset.files = String(files.length);
    },
  };
}

/** @param {string} id @param {ReportSection} section @returns {HTMLElement[]} */
const sectionOf = (id, { title, words, claims, tables, figures }) => [
  element("h4", title),
  ...words.map((each) => element("p", each)),
  ...claims.map(claimOf),
  ...figures.map((figure) => figureOf(id, figure)),
  ...tables.map((table) => tableOf(id, table)),
];

/** @param {Claim} claim */
function claimOf({ text, verdict, sentence, because }) {
  const line = element("p", `${text} `);
  line.className = `claim claim-${verdictKind(verdict)}`;
  line.append(element("strong", sentence), ` ${because}`);
  return line;
}

/** @param {string} id @param {ReportFigure} figure */
function figureOf(id, { file, caption, words }) {
  const figure = element("figure");
  const link = Object.assign(element("a"), { href: experimentFileUrl(id, file) });
  link.append(Object.assign(document.createElement("img"), { src: link.href, alt: words || caption, loading: "lazy" }));
  figure.className = "report-figure";
  figure.append(link, element("figcaption", caption));
  return figure;
}

/** @param {string} id @param {ReportTable} shown */
function tableOf(id, { caption, columns, rows, file }) {
  const box = element("div");
  box.className = "report-table";
  Object.assign(box, { tabIndex: 0, role: "region", ariaLabel: caption });
  const table = document.createElement("table");
  table.className = "figure";
  const title = table.createCaption();
  title.append(`${caption} `, Object.assign(element("a", "CSV"), { href: experimentFileUrl(id, file) }));
  const head = table.createTHead().insertRow();
  head.append(...columns.map((each) => Object.assign(element("th", each), { scope: "col" })));
  const body = table.createTBody();
  for (const cells of rows) {
    const row = body.insertRow();
    row.append(...cells.map((cell, at) => (at ? element("td", cell) : Object.assign(element("th", cell), { scope: "row" }))));
  }
  box.append(table);
  return box;
}

/** @param {string} id @param {ExperimentDetail["files"]} files */
function filesOf(id, files) {
  const details = element("details");
  details.className = "advanced";
  const list = element("ul");
  list.className = "report-files";
  for (const file of sortedFiles(files)) {
    const item = element("li");
    item.append(Object.assign(element("a", fileInWords(file)), { href: experimentFileUrl(id, file.name) }));
    list.append(item);
  }
  details.append(element("summary", `Files of the report (${files.length})`), list);
  return details;
}

/** @template {keyof HTMLElementTagNameMap} K @param {K} name @param {string} [text] @returns {HTMLElementTagNameMap[K]} */
function element(name, text = "") {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}
