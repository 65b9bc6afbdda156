"""JSON lines: the poses file itself (docs/conventions.md, "Poses file")."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from padstudio.flights.exports.options import ExportOptions, Record


def write_jsonl(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """One object a line, UTF-8; numbers read back as the same doubles."""
    for record in records:
        yield json.dumps(record, ensure_ascii=False).encode() + b"\n"
