"""Joins a page's ES modules into one script.

Module *k* becomes ``const mk = (() => { ... return { its, exports }; })();``, and an import the
unpacking of an earlier ``mk``. Modules stand in the order in which a browser evaluates them: depth
first, as their imports name them. That is exact for what our modules use, imports by name, exports
of declarations that never change, no circle; other forms are refused. Lines stay lines, which a
source map tells the browser's debugger.
"""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Callable
from dataclasses import dataclass

_IMPORT = re.compile(r'^import (\*\s+as \w+|\{[^{}]*\}) from "(\.{1,2}/[^"]+\.js)";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:const|class|(?:async )?function\*?) (\w+))", re.MULTILINE)
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
#: What is left of these outside of comments is of a form that is not understood.
_UNKNOWN = re.compile(r"^(?:import|export|await)\b.*|\bimport\.meta\b|\bimport\(.*", re.MULTILINE)


@dataclass(frozen=True)
class Bundle:
    """One script and the map from its lines to those of its modules."""

    script: str
    source_map: str


def bundle(entry: str, read: Callable[[str], str]) -> Bundle:
    """Join a module and all that it imports.

    Parameters
    ----------
    entry : str
        Path of the page's module, such as ``design/design.js``.
    read : callable
        Gives a module's text by its path.

    Raises
    ------
    ValueError
        If a module has imports or exports of another form, or imports go in a circle.
    """
    sources = _in_order(entry, read)
    numbers = {name: number for number, name in enumerate(sources)}
    script: list[str] = []
    origins: list[tuple[int, int] | None] = []
    for name, source in sources.items():
        lines = _as_function(name, source, numbers).split("\n")
        script += lines
        # The first and the last are the function's; those between are the module's own.
        origins += [None, *((numbers[name], line) for line in range(len(lines) - 2)), None]
    return Bundle("\n".join(script) + "\n", _source_map(sources, origins))


def _in_order(entry: str, read: Callable[[str], str]) -> dict[str, str]:
    """Texts of all modules by name, each after those that it imports."""
    done: dict[str, str] = {}
    under_way: list[str] = []

    def visit(name: str) -> None:
        if name in done:
            return
        if name in under_way:
            raise ValueError(f"imports go in a circle: {' -> '.join([*under_way, name])}")
        under_way.append(name)
        source = read(name)
        for match in _IMPORT.finditer(source):
            visit(_resolved(name, match[2]))
        done[under_way.pop()] = source

    visit(entry)
    return done


def _resolved(importer: str, address: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(importer), address))


def _as_function(name: str, source: str, numbers: dict[str, int]) -> str:
    def unpacked(match: re.Match[str]) -> str:
        # `{ a as b }` of an import is `{ a: b }` of an object; a list over lines stays so.
        names, module = match[1], f"m{numbers[_resolved(name, match[2])]}"
        target = names.split()[-1] if names.startswith("*") else re.sub(r"\bas\b", ":", names)
        return f"const {target} = {module};"

    exported = [match[1] for match in _EXPORT.finditer(source)]
    body = _EXPORT.sub("", _IMPORT.sub(unpacked, source)).rstrip("\n")
    left = _UNKNOWN.search(_COMMENT.sub("", body))
    if left:
        raise ValueError(f"{name}: not understood: {left[0]}")
    head = f"const m{numbers[name]} = (() => {{ // {name}"
    return f"{head}\n{body}\nreturn {{ {', '.join(exported)} }}; }})();"


def _source_map(sources: dict[str, str], origins: list[tuple[int, int] | None]) -> str:
    """A source map, revision 3: each line is the start of one of a module."""
    mappings = []
    last = (0, 0)
    for origin in origins:
        if origin is None:
            mappings.append("")
            continue
        # Columns of both are 0; module and line are differences to the ones before.
        steps = (0, origin[0] - last[0], origin[1] - last[1], 0)
        mappings.append("".join(map(_vlq, steps)))
        last = origin
    content = {
        "version": 3,
        "sources": list(sources),
        "sourcesContent": list(sources.values()),
        "names": [],
        "mappings": ";".join(mappings),
    }
    return json.dumps(content, ensure_ascii=False)


def _vlq(value: int) -> str:
    """A number in base 64, five bits a digit, the lowest first; the lowest bit is the sign."""
    digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
    rest = abs(value) << 1 | (value < 0)
    text = ""
    while rest > 31:
        text += digits[rest & 31 | 32]
        rest >>= 5
    return text + digits[rest]
