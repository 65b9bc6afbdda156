"""Records of a server's flight and of a poses file made alike: fields, order, clock and names.

A flight's rows and a line that the command line wrote of the same frame are the same record, so
that an export of either is the same file, byte by byte.
"""

from __future__ import annotations

import itertools
import posixpath
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from padstudio.errors import SpecError
from padstudio.flights.results.completed import completed
from padstudio.geometry.pose import rotation_from_quaternion

Record = dict[str, Any]

#: Seconds from one still to the next, as stills have no times.
STILL_INTERVAL_S = 1.0
# How fields follow each other; those that are not named come before the times, sorted.
_FIRST = ("source", "frame", "time_s", "status", "position_mm", "rotation", "quaternion_xyzw")
_LAST = ("single", "frame_px", "elapsed_ms", "damaged")
_DRIVE = re.compile(r"[A-Za-z]:/")


def alike(records: Iterable[Record]) -> Iterator[Record]:
    """Records complete, on one clock, each with its fields in one order.

    The rotation is that of the quaternion, of which a database keeps no copy.

    Parameters
    ----------
    records : iterable of dict
        As `padstudio.vision.stage.detection.Detection.to_record`, in the order of time.
    """
    for record in on_one_clock(map(completed, records)):
        told = record
        if record["status"] == "ok":
            rotation = rotation_from_quaternion(record["quaternion_xyzw"]).tolist()
            told = record | {"rotation": rotation}
        named = {*_FIRST, *_LAST}
        keys = [*_FIRST, *sorted(key for key in told if key not in named), *_LAST]
        yield {key: told[key] for key in keys if key in told}


def on_one_clock(records: Iterable[Record]) -> Iterator[Record]:
    """Records whose times go on from source to source.

    Poses files of older versions count each video's time from 0. There a video is taken to begin
    one frame after the last that was read of the one before.
    """
    step_s, end_s = 0.0, 0.0
    seen_s: float | None = None
    for _, some in itertools.groupby(records, key=lambda record: record["source"]):
        before_s, shift_s = seen_s, 0.0
        times: list[float] = []
        for record in some:
            time_s = record.get("time_s")
            if time_s is None:
                yield record
                continue
            if before_s is not None and not times and time_s <= before_s:
                shift_s = end_s + (step_s or STILL_INTERVAL_S)
            times.append(time_s)
            end_s = time_s + shift_s
            seen_s = end_s if _was_read(record) else seen_s
            yield record | {"time_s": end_s} if shift_s else record
        step_s = float(np.median(np.diff(times))) if len(times) > 1 else step_s


def timed(records: Iterable[Record]) -> Iterator[tuple[Record, float]]:
    """Records with their times, s; stills are `STILL_INTERVAL_S` apart."""
    number, place = -1, None
    for record in records:
        time_s = record.get("time_s")
        if time_s is not None:
            yield record, float(time_s)
            continue
        # A still may show several pads.
        if (record["source"], record["frame"]) != place:
            number, place = number + 1, (record["source"], record["frame"])
        yield record, number * STILL_INTERVAL_S


@dataclass
class Survey:
    """What a poses file holds, in one pass over it.

    Attributes
    ----------
    pads : set of str
        Identities of those that poses are of.
    qualities : Counter
        Frames by quality: ``full``, ``bearing``, ``unknown``, or ``failed``.
    sources : dict of str to (width, height) or None
        In the order of the file, with the size of the frames of each where it is told.
    topics : dict of str to str
        Of sources that are recordings: that of their frames.
    begin_again : list of str
        Sources whose times begin again behind those of another, as in files of older versions.
    twice : list of str
        Sources of which earlier frames stand behind later ones, as where files were joined.
    stills, videos : int
        Records without and with a time.
    """

    pads: set[str] = field(default_factory=set)
    qualities: Counter[str] = field(default_factory=Counter)
    sources: dict[str, tuple[int, int] | None] = field(default_factory=dict)
    topics: dict[str, str] = field(default_factory=dict)
    begin_again: list[str] = field(default_factory=list)
    twice: list[str] = field(default_factory=list)
    stills: int = 0
    videos: int = 0

    @classmethod
    def of(cls, records: Iterable[Record], pad_id: str | None = None) -> Survey:
        """Go through records; qualities are counted of those of a pad."""
        found, last_s = cls(), None
        for record in records:
            source, time_s, size = record["source"], record.get("time_s"), record.get("frame_px")
            is_behind = time_s is not None and last_s is not None and time_s <= last_s
            if source not in found.sources and is_behind:
                found.begin_again.append(source)
            elif is_behind and time_s != last_s:
                found.twice.append(source)
            if found.sources.get(source) is None:
                found.sources[source] = (size[0], size[1]) if size else None
            if "topic" in record:
                found.topics[source] = record["topic"]
            last_s = time_s if time_s is not None and _was_read(record) else last_s
            found.stills += time_s is None
            found.videos += time_s is not None
            if "pad_id" in record:
                found.pads.add(record["pad_id"])
            if pad_id is None or record.get("pad_id", pad_id) == pad_id:
                found.qualities[_quality(record)] += 1
        return found

    def check_clock(self, form: str, *, is_matched: bool) -> None:
        """Refuse what has no one clock.

        Parameters
        ----------
        form : str
            Of the export, which holds times.
        is_matched : bool
            The times are looked up in a log of the vehicle's.

        Raises
        ------
        SpecError
        """
        if self.stills and self.videos:
            raise SpecError(
                f"stills have no times, videos have: {form} holds one clock, so detect stills and "
                "videos into files of their own, or export as csv or jsonl",
                code="several_clocks",
            )
        if self.twice:
            raise SpecError(
                f"frames of {self.twice[0]} stand behind later ones of it, as in several poses "
                f"files that were joined: {form} holds one flight; export each by itself",
                code="several_clocks",
            )
        if is_matched and self.begin_again:
            raise SpecError(
                f"the times of {self.begin_again[0]} begin again, so that they are not those of "
                "the vehicle's log: the poses file is of an older version; detect again",
                code="several_clocks",
            )


def _was_read(record: Record) -> bool:
    """False of what stands for a file that could not be read, which takes no time."""
    return bool(record.get("stage") != "read")


def _quality(record: Record) -> str:
    return str(record.get("quality") or "unknown") if record["status"] == "ok" else "failed"


def relative_names(sources: Collection[str]) -> dict[str, str]:
    """Names of sources without the folders of the machine that they lie on.

    Absolute ones, and likewise those that lead out of the working folder, lose the folders that all
    of them share; the rest stays as it is.

    Returns
    -------
    dict of str to str
        Of those that change.
    """
    names: dict[str, str] = {}
    paths = {source: posixpath.normpath(source.replace("\\", "/")) for source in sources}
    for is_meant in (_is_absolute, lambda path: path.startswith("../")):
        group = {source: path for source, path in paths.items() if is_meant(path)}
        if group:
            parts = [PurePosixPath(path).parts[:-1] for path in group.values()]
            shared = len(posixpath.commonprefix(parts))
            for source, path in group.items():
                names[source] = "/".join(PurePosixPath(path).parts[shared:]).replace("../", "")
    return names


def _is_absolute(path: str) -> bool:
    return path.startswith("/") or _DRIVE.match(path) is not None
