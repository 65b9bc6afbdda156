"""YAML as plain values, built from the parser's events: no tags, no aliases, bounded depth.

Of several documents the first that holds something is read: ``ros2 topic echo`` ends each message
with ``---``.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

#: Lists and mappings within each other.
MAX_DEPTH = 32
#: Values and keys of a document; a camera file has some hundred, a bag's metadata some thousand.
MAX_VALUES = 200_000

# The parser in C where PyYAML was built with it; both give the same events.
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_PREFIX = "tag:yaml.org,2002:"
_OPENCV = {_PREFIX + "opencv-matrix", _PREFIX + "opencv-nd-matrix"}
_ALLOWED: dict[Any, set[str]] = {
    yaml.ScalarEvent: {"!", _PREFIX + "str"},
    yaml.SequenceStartEvent: {"!", _PREFIX + "seq"},
    yaml.MappingStartEvent: {"!", _PREFIX + "map", *_OPENCV},
}
_INTEGER = re.compile(r"[-+]?\d{1,300}")
_FLOAT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_WORDS = {"": None, "~": None} | {
    spelling: meaning
    for word, meaning in (
        ("null", None),
        *((yes, True) for yes in ("true", "yes", "on")),
        *((no, False) for no in ("false", "no", "off")),
    )
    for spelling in (word, word.capitalize(), word.upper())
}


def parse(text: str) -> Any:
    """Plain values (dict, list, str, number, bool, None) of the first document.

    Keys are texts as they stand.

    Raises
    ------
    yaml.YAMLError
        If it is ill-formed, has tags or aliases, says a key twice, is nested too deep or too long.
    """
    # OpenCV's first line, "%YAML:1.0", is no directive that YAML knows; blank it, so that the line
    # numbers of messages stay true.
    if text.startswith("%YAML"):
        text = text[text.find("\n") :] if "\n" in text else ""
    builder = _Builder()
    for event in yaml.parse(text, Loader=_LOADER):
        if isinstance(event, yaml.DocumentEndEvent) and builder.root is not None:
            break
        builder.take(event)
    return builder.root


class _Builder:
    """Values of a document, of which ``open`` holds the lists and mappings not yet ended."""

    def __init__(self) -> None:
        self.root: Any = None
        self.values = 0
        self.open: list[tuple[Any, str | None]] = []

    def take(self, event: Any) -> None:
        self.values += 1
        if self.values > MAX_VALUES:
            _refuse(event, f"more than {MAX_VALUES} values")
        if isinstance(event, yaml.AliasEvent):
            _refuse(event, "aliases are not read; write the value out")
        tag = getattr(event, "tag", None)
        if tag is not None and tag not in _ALLOWED.get(type(event), ()):
            shown = tag.replace(_PREFIX, "!!")[:60]
            _refuse(event, f"the tag {shown} is not read; write the plain value")
        if isinstance(event, yaml.ScalarEvent):
            self._place(event, event.value if self._wants_key() else _scalar(event))
        elif isinstance(event, yaml.MappingStartEvent | yaml.SequenceStartEvent):
            if self._wants_key():
                _refuse(event, "a key must be a text")
            if len(self.open) >= MAX_DEPTH:
                _refuse(event, f"nested more than {MAX_DEPTH} deep")
            value: Any = {} if isinstance(event, yaml.MappingStartEvent) else []
            self._place(event, value)
            self.open.append((value, None))
        elif isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
            self.open.pop()

    def _wants_key(self) -> bool:
        return bool(self.open) and isinstance(self.open[-1][0], dict) and self.open[-1][1] is None

    def _place(self, event: Any, value: Any) -> None:
        if not self.open:
            self.root = value
            return
        inside, key = self.open[-1]
        if isinstance(inside, list):
            inside.append(value)
        elif key is None:
            if value in inside:
                _refuse(event, f"{value[:60]} stands twice; leave one")
            self.open[-1] = (inside, value)
        else:
            inside[key] = value
            self.open[-1] = (inside, None)


def _scalar(event: Any) -> Any:
    text = event.value
    if not event.implicit[0]:
        return text
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _FLOAT.fullmatch(text):
        # Python's spelling of ".inf" and ".nan" has no point.
        return float(text if text[-1] in "0123456789." else text.replace(".", ""))
    return text


def _refuse(event: Any, problem: str) -> None:
    raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
