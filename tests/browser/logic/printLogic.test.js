import {
  cellFacts, DEFAULT_PRINT, fileQuery, keptStrip, parsePrint, planFacts, printFromQuery, printToQuery,
  readings, rulerTexts, shapeOfPad, sheetOptions, stripInWords,
} from "/static/js/design/printLogic.js";
import { contains, equal } from "./check.js";

const parse = (change) => parsePrint({ ...DEFAULT_PRINT, ...change });
const PLAN = {
  paper: "A4", orientation: "portrait", paper_mm: [210, 297], page_mm: [400, 300], rows: 2, cols: 3,
  count: 6, paper_m2: 0.3742, on_cells: true, x_seams_mm: [], y_seams_mm: [], sheets: [{ name: "A1" }, { name: "B3" }],
};
const PAD = {
  name: "p", window: 5, levels: 2, quietMm: 4, widthMm: 60, heightMm: 40,
  layers: [
    { channel: "red", rows: 4, cols: 6, cellMm: 10, levels: new Uint8Array(24) },
    { channel: "blue", rows: 2, cols: 3, cellMm: 20, levels: new Uint8Array(6) },
  ],
};

export const tests = {
  "the defaults are sound, and no address is needed for them": () => {
    equal(parse({}).errors, {});
    equal(printToQuery(printFromQuery(new URLSearchParams())), {});
  },
  "a change goes to the address and comes back": () => {
    const texts = { ...DEFAULT_PRINT, paper: "A3", header: "a & b" };
    equal(printToQuery(texts), { paper: "A3", header: "a & b" });
    equal(printFromQuery(new URLSearchParams(printToQuery(texts))), texts);
  },
  "another size of sheet is read, or said how to write": () => {
    equal(parse({ paper: "custom", custom: " 914 × 5000 " }).options.paper, "914x5000");
    equal(parse({ paper: "custom", custom: "91.4x500" }).options.paper, "91.4x500");
    contains(parse({ paper: "custom", custom: "large" }).errors.custom, "width × height");
  },
  "lengths out of bounds are named": () => {
    contains(parse({ margin_mm: "-1" }).errors.margin_mm, "from 0 to 1000");
    contains(parse({ dpi: "" }).errors.dpi, "Resolution");
    equal(parse({ overlap_mm: "0" }).options, null);
  },
  "the planner gets numbers, and on one page of its own size no margin": () => {
    equal(sheetOptions(parse({}).options), {
      paper: "A4", orientation: "auto", margin_mm: 5, joint: "butt", overlap_mm: 10, seams: "cells",
    });
    equal("margin_mm" in sheetOptions(parse({ paper: "own" }).options), false);
  },
  "a file's address holds what its form takes": () => {
    const { options } = parse({ header: "north", dpi: "300" });
    equal(fileQuery("pdf", options), "?paper=A4&header=north");
    equal(fileQuery("png", options), "?dpi=300");
    equal(fileQuery("svg", options), "");
    equal(fileQuery("pdf", parse({ paper: "own" }).options), "");
    equal(fileQuery("strip.pdf", parse({ paper: "own" }).options), "?paper=A4");
  },
  "the shape of a pad is what the server asks for": () => {
    equal(shapeOfPad(PAD), {
      window: 5, levels: 2, quiet_mm: 4,
      layers: [
        { channel: "red", rows: 4, cols: 6, cell_mm: 10 },
        { channel: "blue", rows: 2, cols: 3, cell_mm: 20 },
      ],
    });
  },
  "sheets, paper and cells in words": () => {
    const facts = Object.fromEntries(planFacts(PLAN));
    equal(facts.Sheets, "6 of paper size A4, portrait");
    equal(facts["Sheet names"], "A1 to B3");
    equal(facts.Joined, "2 × 3 sheets, 400 × 300 mm");
    equal([facts["Total paper"], facts.Seams], ["0.37 m²", "on cell edges"]);
    equal(planFacts({ ...PLAN, count: 1, paper: "own size" })[0], ["Sheets", "1 of the pad's own size"]);
    equal(cellFacts(PAD, [1, 1]), [["One red cell", "10 mm"], ["One blue cell", "20 mm"]]);
    equal(cellFacts(PAD, [0.996, 1])[1], ["One blue cell", "19.92 × 20 mm"]);
  },
  "readings of the rulers": () => {
    equal(readings("199.2", "200.4"), { x_mm: 199.2, y_mm: 200.4, ruler_mm: 200 });
    equal([readings("", "200"), readings("20", "200"), readings("x", "200")], [null, null, null]);
    equal(rulerTexts([0.996, 1.002]), ["199.2", "200.4"]);
  },
  "the strip in words": () => {
    const found = stripInWords({
      matrix: [[1, 0, 0.04], [0, 1, 0], [0.11, 0, 1]], red_separation: 0.5, blue_separation: 0.1,
      warnings: ["use purer inks"], kept: true,
    });
    equal(found.facts[3], ["Blue in the red channel", "4 %"]);
    equal(found.facts[2], ["Red in the blue channel", "11 %"]);
    equal(found.warnings, ["Use purer inks."]);
    equal([found.kept, found.note.startsWith("Kept with the pad")], [true, true]);
  },
  "the strip that a pad was stored with": () => {
    const crosstalk = { matrix: [], red_separation: 0.5, blue_separation: 0.4, warnings: [] };
    equal(keptStrip({ crosstalk }), { ...crosstalk, kept: true });
    equal(keptStrip({ crosstalk: null }), null);
  },
};
