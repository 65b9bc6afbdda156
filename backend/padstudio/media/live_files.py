"""What lies in the folder of a live session's recording, and in a zip of it."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from padstudio.media.content import ContentError
from padstudio.media.zip_stills import ZipLimits, check_entry, entries_of, is_hidden

#: The file that makes a folder a recording.
SESSION = "session.json"


def live_members(path: Path, limits: ZipLimits) -> dict[str, str]:
    """The files of a recording in a zip: names in its folder, and in the zip.

    Empty where the zip holds something else.

    Raises
    ------
    ContentError, LimitError
        As `padstudio.media.zip_stills.list_stills`, or if it holds several recordings.
    """
    entries = [entry for entry in entries_of(path, limits) if not is_hidden(entry)]
    places = {entry.filename: PurePosixPath(entry.filename) for entry in entries}
    folders = [place.parent for place in places.values() if place.name == SESSION]
    if not folders:
        return {}
    if len(folders) > 1:
        raise ContentError("the zip holds several live recordings; upload each by itself")
    mine = [entry for entry in entries if places[entry.filename].parent == folders[0]]
    for entry in mine:
        check_entry(entry, limits, limits.unpacked_bytes)
    found = {places[entry.filename].name: entry.filename for entry in mine}
    if len(found) < len(mine):
        raise ContentError("two files in the zip have one name; pack it again", code="damaged_zip")
    return found
