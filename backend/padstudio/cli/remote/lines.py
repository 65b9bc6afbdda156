"""A flight's frames as the lines of the poses file that `padstudio detect` makes of the same files.

Frames' own poses come from the server as they were measured there; over time they are fused here,
by the very function that `detect` uses, so that files are equal to the last digit.
"""

from __future__ import annotations

import json
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from padstudio.flights.results.fusing import Fusion, fused_records

Record = dict[str, Any]

# The order in which `padstudio detect` writes them.
_KEYS = (
    "source", "frame", "time_s", "status", "stage", "reason", "detail", "advice", "failed_at",
    "position_mm", "rotation", "quaternion_xyzw", "heading_deg", "tilt_deg", "euler_deg",
    "range_mm", "bearing", "layer", "cells_read", "cells_wrong", "log10_false_alarm",
    "reprojection_px", "ambiguity", "flatness_mm", "position_sigma_mm", "attitude_sigma_deg",
    "range_sigma_mm", "bearing_sigma_deg", "quality", "estimate", "pad_id", "findings",
    "frame_px", "elapsed_ms", "covariance", "topic", "stamp_ns", "damaged", "single",
)  # fmt: skip
_PLACES = {key: place for place, key in enumerate(_KEYS)}


def lines_of(
    export: Iterable[bytes], sources: Sequence[Record], names: Sequence[str], fusion: Fusion
) -> Iterator[Record]:
    """Lines of a poses file.

    Parameters
    ----------
    export : iterable of bytes
        Lines of the flight's export ``jsonl``.
    sources : sequence of dict
        As the flight has them.
    names : sequence of str
        What each is called in the file.
    fusion : {"none", "filter", "smooth"}

    Yields
    ------
    dict
    """
    firsts = [source["first_frame"] for source in sources]

    def named() -> Iterator[Record]:
        for line in export:
            record = json.loads(line)
            place = bisect_right(firsts, record["frame"]) - 1
            name = names[place]
            if sources[place]["kind"] == "stills":
                name = f"{name}/{record['source']}"
            yield record | {"source": name}

    for record in fused_records(named(), fusion):
        yield dict(sorted(record.items(), key=lambda item: _PLACES.get(item[0], len(_KEYS))))
