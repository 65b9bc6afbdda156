from __future__ import annotations

import json
import re

import pytest
from joined_modules import joined
from places import ROOT

from padstudio.web.pages.bundles import bundle

SCRIPTS = ROOT / "frontend" / "js"
PAGES = ("design", "diagnose", "flight", "flights", "plan", "cameras", "live", "experiments")


def test_each_module_stands_once_and_before_its_importers() -> None:
    heads = re.findall(r"^const m\d+ = .*// (.*)$", joined().script, re.MULTILINE)
    assert heads == ["shared/numbers.js", "shared/words.js", "page/page.js"]


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
