"""``padstudio live``: poses from a camera's stream, as its frames come."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import typer

from padstudio.autopilot.vehicle import Mount
from padstudio.cli.live import options as opts
from padstudio.cli.live.notes import Notes, StatsTeller, show_end
from padstudio.cli.live.wiring import MavlinkWishes, Wired, Wishes, wired
from padstudio.cli.outcomes import EXIT_NOTHING_FOUND
from padstudio.cli.reading_options import MethodName, Param, Quiet
from padstudio.cli.support import (
    EXIT_USAGE,
    Down,
    Forward,
    LeanForward,
    LeanRight,
    NoDistortion,
    Right,
    Turned,
    note,
    open_camera,
    show_error,
)
from padstudio.flights.tasks.detectors import params_from, params_of_words
from padstudio.live.session import LiveSession, SessionOptions
from padstudio.live.stats import stats_of
from padstudio.live.stream.addresses import StreamAddress, parse_address
from padstudio.live.stream.live_stream import LiveStream
from padstudio.live.stream.options import StreamOptions
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.vision.warm import warm_up

_EXAMPLES = (
    "Examples: [bold]padstudio live rtsp://192.168.1.10/stream --pad pad.json --camera camera.yaml "
    "| jq .position_mm[/] · [bold]padstudio live /dev/video0 --pad pad.json --camera camera.yaml "
    "--mavlink serial:/dev/ttyAMA0:921600 --record flights --stats[/]"
)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(live)


def live(
    source: opts.Source,
    pad: opts.PadFiles,
    camera: opts.CameraName,
    no_distortion: NoDistortion = False,
    transport: opts.Transport = "tcp",
    realtime: opts.Realtime = False,
    loop: opts.Loop = False,
    verify_tls: opts.VerifyTls = True,
    late_ms: opts.Late = 300.0,
    size: opts.Size = None,
    rate_hz: opts.Rate = None,
    method: MethodName = "dense",
    param: Param = None,
    mavlink: opts.Mavlink = None,
    profile: opts.ProfileName = "auto",
    message: opts.MessageName = "landing_target",
    max_age_ms: opts.MaxAge = None,
    max_hz: opts.MaxHz = 30.0,
    system_id: opts.SystemId = None,
    page_heading_deg: opts.PageHeading = 0.0,
    signing_key: opts.SigningKey = None,
    turned_deg: Turned = 0.0,
    lean_forward_deg: LeanForward = 0.0,
    lean_right_deg: LeanRight = 0.0,
    forward_m: Forward = 0.0,
    right_m: Right = 0.0,
    down_m: Down = 0.0,
    json_to: opts.JsonTo = None,
    udp: opts.Udp = None,
    http: opts.Http = None,
    record: opts.Record = None,
    stats: opts.Stats = False,
    stats_json: opts.StatsJson = False,
    duration_s: opts.Duration = None,
    quiet: Quiet = False,
) -> None:
    """Poses from a camera's stream as its frames come: always the newest frame.

    What cannot be read in time is dropped and counted. A lost stream is opened again. Ctrl-C or
    SIGTERM ends it in order.

    The exit code is 0 if a frame gave a pose, 1 if none did, 2 for wrong input, a source that is
    refused, too.
    """
    if not os.environ.get("PADSTUDIO_DEBUG"):
        logging.getLogger("padstudio").setLevel(logging.CRITICAL)
    address = parse_address(source)
    if address.kind != "file" and (realtime or loop):
        raise typer.BadParameter("--realtime and --loop are of files; a stream has its own time")
    stream_options = StreamOptions(
        transport=transport,
        late_s=late_ms / 1000,
        verify_tls=verify_tls,
        loop=loop,
        size_px=opts.size_px(size),
        rate_hz=rate_hz,
    )
    settings = params_of_words(param or [])
    pads = [Pad.load(path) for path in pad]
    the_camera = open_camera(camera, no_distortion=no_distortion)
    if the_camera.nominal:
        note(f"camera {the_camera.name}: nominal, calibrate for accuracy")
    detector = Detector(pads, the_camera, method=method, params=params_from(settings))
    lean, place = (lean_forward_deg, lean_right_deg), np.array([forward_m, right_m, down_m])
    mavlink_wishes = mavlink and MavlinkWishes(
        address=mavlink,
        settings={
            "profile": profile,
            "message": message,
            "max_hz": max_hz,
            "system_id": system_id,
            "heading_deg": page_heading_deg,
        },
        mount=Mount.leaning(turned_deg, lean, place),
        signing_key=signing_key,
    )
    nothing = not (mavlink or udp or http or record)
    wishes = Wishes(
        source=address.shown,
        json_to="-" if json_to is None and nothing else json_to,
        udp=udp,
        http=http,
        record=record,
        mavlink=mavlink_wishes or None,
        max_age_s=None if max_age_ms is None else max_age_ms / 1000,
        quiet=quiet,
    )
    telling = "json" if stats_json else "lines" if stats else ""
    run = _Run(address, stream_options, SessionOptions(duration_s=duration_s), telling, quiet)
    run(wishes, detector, settings)


class _Run:
    """One session from its beginning to its exit code."""

    def __init__(
        self,
        address: StreamAddress,
        stream: StreamOptions,
        session: SessionOptions,
        telling: str,
        quiet: bool,
    ) -> None:
        self._address, self._stream, self._options = address, stream, session
        self._telling, self._quiet = telling, quiet
        self._session: LiveSession | None = None

    def __call__(self, wishes: Wishes, detector: Detector, settings: dict[str, Any]) -> None:
        with wired(wishes, detector, settings, self._stop) as outputs:
            if not self._quiet:
                outputs.outputs.append(Notes())
            stream = LiveStream(self._address, self._stream, outputs.taps)
            with contextlib.closing(stream):
                # While the stream is being opened; loops that are loaded later cost poses.
                warm_up()
                stream.begin()
                self._read(detector, stream, outputs)
            end = stream.state
        assert self._session is not None
        counts = self._session.counts
        if not self._quiet:
            show_end(stats_of(self._session, stream))
        if end.phase == "refused":
            show_error(end.detail, end.code)
            raise typer.Exit(EXIT_USAGE)
        if not counts.poses:
            raise typer.Exit(EXIT_NOTHING_FOUND)

    def _read(self, detector: Detector, stream: LiveStream, outputs: Wired) -> None:
        session = LiveSession(detector, stream, outputs.outputs, self._options)
        self._session = session

        def figures() -> dict[str, Any]:
            others = {name: figure() for name, figure in outputs.figures.items()}
            return stats_of(session, stream) | {"outputs": others}

        with outputs.served(figures), _until_told(session.stop):
            teller = (
                StatsTeller(figures, as_json=self._telling == "json") if self._telling else None
            )
            try:
                session.run()
            finally:
                if teller is not None:
                    teller.close()

    def _stop(self) -> None:
        """End the session: who reads its lines has gone away."""
        if self._session is not None:
            self._session.stop()


@contextlib.contextmanager
def _until_told(stop: Callable[[], None]) -> Iterator[None]:
    """SIGINT and SIGTERM end a session in order; a second one ends the program."""
    told = (signal.SIGINT, signal.SIGTERM)

    def handle(number: int, _frame: object) -> None:
        signal.signal(number, before[number])
        stop()

    before: dict[int, Any] = {number: signal.getsignal(number) for number in told}
    for number in told:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number in told:
            signal.signal(number, before[number])
