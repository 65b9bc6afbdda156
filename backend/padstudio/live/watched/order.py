"""What a session in a process of its own is to do, and what it says of itself."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from padstudio.live.stream.addresses import StreamAddress

#: The source of a session whose frames are pushed to it.
BROWSER = "browser"


@dataclass(frozen=True)
class LiveOrder:
    """A session to be held; picklable.

    Attributes
    ----------
    source : str
        `BROWSER`, or what is shown of a stream's address.
    pads : tuple of str
        The content of pad files.
    camera : str
        The content of a camera file.
    max_pixels : int
        Limit on pictures.
    recordings : Path
        Folder in which recordings get folders of their own.
    address : StreamAddress or None
        Of the stream, as it may be opened; None where frames are pushed.
    """

    source: str
    pads: tuple[str, ...]
    camera: str
    max_pixels: int
    recordings: Path
    address: StreamAddress | None = None


@dataclass(frozen=True)
class Told:
    """What the process says of its own accord; picklable.

    Attributes
    ----------
    kind : {"state", "pose", "failed"}
        ``state`` has all that a page shows but poses; ``pose`` a frame's number and record;
        ``failed`` a code and a message, and is the last.
    values : dict
    """

    kind: str
    values: dict[str, Any] = field(default_factory=dict)
