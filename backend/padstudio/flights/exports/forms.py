"""All forms of export by name."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from padstudio.errors import NotFoundError, shown
from padstudio.flights.exports.colmap import write_colmap
from padstudio.flights.exports.frames.records import alike
from padstudio.flights.exports.mavlink import write_ardupilot, write_px4
from padstudio.flights.exports.mcap_log import write_mcap
from padstudio.flights.exports.options import ExportOptions, Record, in_blocks
from padstudio.flights.exports.ros2_bag import write_ros2
from padstudio.flights.exports.text_tables import write_csv, write_jsonl, write_tum


@dataclass(frozen=True)
class Form:
    """A form that poses can be written in.

    Attributes
    ----------
    write : callable
        From records and options to pieces of bytes.
    suffix : str
        Ending of its files.
    media_type : str
    title : str
        A line for people.
    """

    write: Callable[[Iterable[Record], ExportOptions], Iterator[bytes]]
    suffix: str
    media_type: str
    title: str


FORMS: dict[str, Form] = {
    "csv": Form(write_csv, ".csv", "text/csv", "A row a frame, for spreadsheets and pandas."),
    "jsonl": Form(write_jsonl, ".jsonl", "application/jsonl", "The poses file itself."),
    "tum": Form(write_tum, ".tum.txt", "text/plain", "TUM trajectory, for evo; full poses only."),
    "colmap": Form(
        write_colmap,
        ".colmap.zip",
        "application/zip",
        "COLMAP text model: cameras, images of full poses.",
    ),
    "mcap": Form(
        write_mcap,
        ".mcap",
        "application/octet-stream",
        "MCAP for Foxglove: images, calibration, poses, annotations.",
    ),
    "ros2": Form(
        write_ros2,
        ".ros2.zip",
        "application/zip",
        "ROS 2 bag, zipped: poses with covariance, transforms; full poses only.",
    ),
    "ardupilot": Form(
        write_ardupilot,
        ".ardupilot.tlog",
        "application/octet-stream",
        "MAVLink LANDING_TARGET in the body frame, as ArduPilot reads it.",
    ),
    "px4": Form(
        write_px4,
        ".px4.tlog",
        "application/octet-stream",
        "MAVLink LANDING_TARGET in the local frame, as PX4 reads it; needs the vehicle's poses.",
    ),
}

#: Forms whose readers take every pose for true: those of another quality are left out.
FULL_POSES_ONLY = ("tum", "colmap", "ros2")
#: Forms that hold frames on one clock.
TIMED = ("tum", "mcap", "ros2", "ardupilot", "px4")


def export(
    form: str, records: Iterable[Record], options: ExportOptions | None = None
) -> Iterator[bytes]:
    """Write records in a form.

    What is missing is told at once; records beyond the first block are read as bytes are asked for.

    Parameters
    ----------
    form : str
        A key of `FORMS`.
    records : iterable of dict
        As `padstudio.vision.stage.detection.Detection.to_record`, in the order of time.
    options : ExportOptions or None

    Returns
    -------
    iterator of bytes
        The file in blocks.

    Raises
    ------
    NotFoundError
        If there is no such form.
    SpecError
        If the form needs what the options do not have.
    EmptyExportError
        If the file would hold nothing of what its form is for.
    """
    if form not in FORMS:
        raise NotFoundError(f"there is no form {shown(form)}; there are {', '.join(FORMS)}")
    blocks = in_blocks(FORMS[form].write(alike(records), options or ExportOptions()))
    # What there is nothing of is told before anybody has begun to write or to send.
    first = next(blocks, b"")
    return itertools.chain((first,), blocks)
