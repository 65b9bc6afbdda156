"""Options of ``padstudio live``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

import typer

from padstudio.cli.support import finite

_SOURCE, _MAVLINK, _OUT, _HOW = "Source", "Autopilot (MAVLink)", "Other outputs", "Session"

Source = Annotated[
    str,
    typer.Argument(
        help="rtsp://, rtsps://, udp://, rtp://, http://, https://, an .sdp file, a capture device "
        "(/dev/video0, avfoundation:NAME, dshow:NAME), or a video file, at its own rate."
    ),
]
PadFiles = Annotated[
    list[Path], typer.Option("--pad", help="Pad file; again for more pads that may be in view.")
]
CameraName = Annotated[
    str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
]
Transport = Annotated[
    Literal["tcp", "udp"],
    typer.Option(help="How RTSP brings its pictures.", rich_help_panel=_SOURCE),
]
Realtime = Annotated[
    bool,
    typer.Option(
        "--realtime",
        help="Of a file: its frames come at its own rate, as they always do here.",
        rich_help_panel=_SOURCE,
    ),
]
Loop = Annotated[
    bool,
    typer.Option("--loop", help="Of a file: begin again at its end.", rich_help_panel=_SOURCE),
]
VerifyTls = Annotated[
    bool,
    typer.Option(
        help="Check who the other side of rtsps:// and https:// is.", rich_help_panel=_SOURCE
    ),
]
Late = Annotated[
    float,
    typer.Option(
        "--late-ms",
        min=10,
        max=600_000,
        callback=finite,
        help="What waits longer for its decoder is passed over where a keyframe is behind it.",
        rich_help_panel=_SOURCE,
    ),
]
Size = Annotated[
    str | None,
    typer.Option(
        metavar="WIDTHxHEIGHT", help="Of a capture device's frames.", rich_help_panel=_SOURCE
    ),
]
Rate = Annotated[
    float | None,
    typer.Option(
        min=0.1,
        max=1000,
        callback=lambda value: None if value is None else finite(value),
        help="Of a capture device, frames a second.",
        rich_help_panel=_SOURCE,
    ),
]
Mavlink = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Autopilot: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT, serial:DEVICE:BAUD.",
        rich_help_panel=_MAVLINK,
    ),
]
ProfileName = Annotated[
    Literal["auto", "ardupilot", "px4"],
    typer.Option(help="Whose LANDING_TARGET; auto: by its heartbeat.", rich_help_panel=_MAVLINK),
]
MessageName = Annotated[
    Literal["landing_target", "position_estimate"],
    typer.Option(
        help="LANDING_TARGET, or VISION_POSITION_ESTIMATE in its stead.", rich_help_panel=_MAVLINK
    ),
]
MaxAge = Annotated[
    float | None,
    typer.Option(
        "--max-age-ms",
        min=1,
        max=10_000,
        callback=lambda value: None if value is None else finite(value),
        help="A pose whose frame was taken longer ago is sent neither by MAVLink nor UDP.",
        rich_help_panel=_MAVLINK,
    ),
]
MaxHz = Annotated[
    float,
    typer.Option(
        min=0.1, max=1000, callback=finite, help="Poses a second.", rich_help_panel=_MAVLINK
    ),
]
SystemId = Annotated[
    int | None,
    typer.Option(
        min=1, max=255, help="Of the vehicle, where several are heard.", rich_help_panel=_MAVLINK
    ),
]
PageHeading = Annotated[
    float,
    typer.Option(
        "--page-heading-deg",
        min=-360,
        max=360,
        callback=finite,
        help="Of up on the page, clockwise from north; for position estimates.",
        rich_help_panel=_MAVLINK,
    ),
]
SigningKey = Annotated[
    Path | None,
    typer.Option(help="File with the key that signs messages.", rich_help_panel=_MAVLINK),
]
JsonTo = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="FILE",
        help="JSON lines, one a frame; - is stdout, and what is done where nothing else is asked.",
        rich_help_panel=_OUT,
    ),
]
Udp = Annotated[
    str | None,
    typer.Option(
        "--udp",
        metavar="HOST:PORT",
        help="One JSON datagram a frame.",
        rich_help_panel=_OUT,
    ),
]
Http = Annotated[
    str | None,
    typer.Option(
        "--http",
        metavar="HOST:PORT",
        help="Server-Sent Events, figures, pictures and traces of recent frames.",
        rich_help_panel=_OUT,
    ),
]
Record = Annotated[
    Path | None,
    typer.Option(
        "--record",
        metavar="DIR",
        help="Keep the stream as it came, and the poses, in a new folder within this one.",
        rich_help_panel=_OUT,
    ),
]
Stats = Annotated[
    bool,
    typer.Option("--stats", help="Figures on stderr every few seconds.", rich_help_panel=_HOW),
]
StatsJson = Annotated[
    bool,
    typer.Option(
        "--stats-json", help="The same, as JSON lines for programs.", rich_help_panel=_HOW
    ),
]
Duration = Annotated[
    float | None,
    typer.Option(
        "--duration-s",
        min=0.0,
        callback=lambda value: None if value is None else finite(value),
        help="End after so long.",
        rich_help_panel=_HOW,
    ),
]

_ADDRESS = re.compile(r"(?:\[([^\[\]]+)\]|([^:\[\]]*)):(\d{1,5})")


def host_and_port(text: str, option: str) -> tuple[str, int]:
    """``HOST:PORT``, an IPv6 address in brackets.

    Raises
    ------
    typer.BadParameter
    """
    found = _ADDRESS.fullmatch(text)
    if found is None or int(found[3]) > 65535:
        raise typer.BadParameter(f"{option} is HOST:PORT, as 127.0.0.1:5005 or [::1]:5005")
    return found[1] or found[2] or "127.0.0.1", int(found[3])


def size_px(text: str | None) -> tuple[int, int] | None:
    """``WIDTHxHEIGHT``.

    Raises
    ------
    typer.BadParameter
    """
    if text is None:
        return None
    found = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if found is None:
        raise typer.BadParameter("--size is width x height, as 1920x1080")
    return int(found[1]), int(found[2])
