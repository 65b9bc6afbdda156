"""The export of a poses file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from padstudio.errors import EmptyExportError
from padstudio.flights.exports.forms import TIMED, export
from padstudio.flights.exports.frames.files import SourceFiles
from padstudio.flights.exports.frames.pads import check_pad, of_pad
from padstudio.flights.exports.frames.records import Survey, relative_names
from padstudio.flights.exports.from_log import track_of
from padstudio.flights.exports.options import ExportChoices, ExportOptions, Record
from padstudio.flights.results.poses_file import read_poses
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad


@dataclass(frozen=True, kw_only=True)
class PosesFile:
    """A poses file, and what it does not say.

    Attributes
    ----------
    path : Path
    folder : Path
        To which its sources are relative.
    camera : Camera or None
    pad : Pad or None
    frame_px : (width, height) or None
        Of frames whose size it does not say; None looks at the sources.
    """

    path: Path
    folder: Path = Path()
    camera: Camera | None = None
    pad: Pad | None = None
    frame_px: tuple[int, int] | None = None


@dataclass(frozen=True)
class FileExport:
    """The export of a poses file, once its blocks are asked for."""

    blocks: Iterator[bytes]
    survey: Survey
    files: SourceFiles


def export_file(poses: PosesFile, choices: ExportChoices) -> FileExport:
    """Write a poses file in a form; as `padstudio.flights.exports.forms.export`.

    Raises
    ------
    PosesFormatError
        If a line of the file is no record: it is read once in advance.
    EmptyExportError
        If it has none.
    SpecError
        If its poses are of several pads, or its frames have no one clock, as the form asks for.
    """
    survey = Survey.of(read_poses(poses.path), choices.pad_id)
    if not survey.sources:
        raise EmptyExportError(f"{poses.path.name} holds no frames: nothing was written to it")
    check_pad(choices.form, survey.pads, choices.pad_id)
    if choices.form in TIMED:
        is_matched = choices.vehicle is not None or choices.log is not None
        survey.check_clock(choices.form, is_matched=is_matched)

    def records() -> Iterator[Record]:
        return of_pad(read_poses(poses.path), choices.pad_id)

    vehicle = choices.vehicle
    if vehicle is None and choices.log is not None:
        vehicle = track_of(choices.log, records())
    files = SourceFiles(poses.folder, survey.sources, survey.topics)
    size = poses.frame_px
    options = ExportOptions(
        camera=poses.camera,
        frame_px=files.frame_px if size is None else lambda record: size,
        names=relative_names(survey.sources),
        pad_size_mm=None if poses.pad is None else poses.pad.size_mm,
        picture=files.picture if choices.images else None,
        start_unix_s=choices.start_unix_s,
        mount=choices.mount,
        vehicle=vehicle,
    )
    return FileExport(export(choices.form, records(), options), survey, files)
