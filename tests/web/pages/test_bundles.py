from __future__ import annotations

import json
import re
import shutil
import subprocess

import pytest
from places import ROOT

from padstudio.web.pages.bundles import Bundle, bundle

SCRIPTS = ROOT / "frontend" / "js"
PAGES = ("design", "diagnose", "flight", "flights", "plan")

MODULES = {
    "page/page.js": """import * as words from "../shared/words.js";
import {
  double as twice,
  Counter,
} from "../shared/numbers.js";

log(words.greet("you"), twice(4), new Counter().next());
""",
    "shared/words.js": """import { double } from "./numbers.js";
log("words");
/** @param {import("./numbers.js").Counter} unused */
export const greet = (name) => `hello ${name} ${double(1)}`;
""",
    "shared/numbers.js": """log("numbers");
const by = 2;
export function double(x) {
  return by * x;
}
export class Counter {
  next() { return 1; }
}
export async function* never() {}
""",
}


def joined(**changed: str) -> Bundle:
    texts = MODULES | {name.replace("__", "/") + ".js": text for name, text in changed.items()}
    return bundle("page/page.js", texts.__getitem__)


def test_each_module_stands_once_and_before_its_importers() -> None:
    heads = re.findall(r"^const m\d+ = .*// (.*)$", joined().script, re.MULTILINE)
    assert heads == ["shared/numbers.js", "shared/words.js", "page/page.js"]


@pytest.mark.skipif(shutil.which("node") is None, reason="no Node to run it")
def test_it_runs_as_its_modules_do() -> None:
    program = "const said = [];\nconst log = (...w) => said.push(...w);\n" + joined().script
    answer = subprocess.run(
        ["node", "--input-type=module"],
        input=program + "console.log(JSON.stringify(said));",
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(answer.stdout) == ["numbers", "words", "hello you 2", 8, 1]


def decoded(mappings: str) -> list[tuple[int, int] | None]:
    """Module and line of each line of a script."""
    digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
    module = line = 0
    found: list[tuple[int, int] | None] = []
    for segment in mappings.split(";"):
        if not segment:
            found.append(None)
            continue
        steps, value, shift = [], 0, 0
        for letter in segment:
            digit = digits.index(letter)
            value |= (digit & 31) << shift
            shift += 5
            if not digit & 32:
                steps.append(-(value >> 1) if value & 1 else value >> 1)
                value = shift = 0
        module, line = module + steps[1], line + steps[2]
        found.append((module, line))
    return found


@pytest.mark.parametrize("page", PAGES)
def test_every_line_leads_back_to_its_own(page: str) -> None:
    bundled = bundle(f"{page}/{page}.js", lambda name: (SCRIPTS / name).read_text("utf-8"))
    table = json.loads(bundled.source_map)
    sources = [text.split("\n") for text in table["sourcesContent"]]
    lines = bundled.script.split("\n")
    for line, origin in zip(lines, decoded(table["mappings"]), strict=False):
        if origin is None:
            continue
        source = sources[origin[0]][origin[1]]
        if not source.startswith(("import ", "} from ")):
            assert line in (source, source.removeprefix("export ")), (page, origin)


@pytest.mark.parametrize(
    "line",
    [
        'import words from "./numbers.js";',
        'import "./numbers.js";',
        'import { double } from "elsewhere";',
        'export * from "./numbers.js";',
        "export default 4;",
        "export let x = 4;",
        "export { x };",
        'const later = () => import("./numbers.js");',
        "const here = import.meta.url;",
        "await never();",
    ],
)
def test_other_forms_are_refused(line: str) -> None:
    with pytest.raises(ValueError, match=r"shared/words\.js: not understood"):
        joined(shared__words=line + "\n")


def test_a_circle_is_refused() -> None:
    back = 'import { greet } from "./words.js";\n'
    with pytest.raises(ValueError, match=r"circle: .*numbers.js -> shared/words.js"):
        joined(shared__numbers=back)
