"""Makes the outputs that the options of ``padstudio live`` ask for."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from padstudio.autopilot.vehicle import Mount
from padstudio.cli.live.options import host_and_port
from padstudio.cli.support import check_output, note
from padstudio.live.outputs.datagrams import Datagrams
from padstudio.live.outputs.json_lines import JsonLines
from padstudio.live.outputs.records import Records
from padstudio.live.reports.report import Output
from padstudio.live.reports.source import PacketTap
from padstudio.vision.detector import Detector

if TYPE_CHECKING:
    from padstudio.live.outputs.mavlink.output import MavlinkOutput


@dataclass(frozen=True, kw_only=True)
class MavlinkWishes:
    """What was asked of MAVLink; None keeps the default."""

    address: str
    settings: dict[str, Any]
    mount: Mount
    signing_key: Path | None


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """Which outputs were asked for.

    Attributes
    ----------
    source : str
        The stream's name, without a password.
    """

    source: str
    json_to: str | None = None
    udp: str | None = None
    record: Path | None = None
    http: str | None = None
    mavlink: MavlinkWishes | None = None
    max_age_s: float | None = None
    quiet: bool = False


@dataclass
class Wired:
    """Outputs, and what else wants the packets."""

    outputs: list[Output] = field(default_factory=list)
    taps: list[PacketTap] = field(default_factory=list)
    figures: dict[str, Callable[[], Any]] = field(default_factory=dict)
    monitor: Callable[[Callable[[], dict[str, Any]]], AbstractContextManager[str]] | None = None

    @contextmanager
    def served(self, stats: Callable[[], dict[str, Any]]) -> Iterator[None]:
        """Serve the session's figures and frames, where that was asked for."""
        if self.monitor is None:
            yield
            return
        with self.monitor(stats) as address:
            note(f"live: {address}/events")
            yield


@contextmanager
def wired(
    wishes: Wishes, detector: Detector, params: dict[str, Any], stop: Callable[[], None]
) -> Iterator[Wired]:
    """Outputs, open; the session closes them, and files are closed in the end.

    Parameters
    ----------
    wishes : Wishes
    detector : Detector
    params : dict
        Of the detector, those that are not the defaults.
    stop : callable
        Ends the session, where who reads its lines has gone away.
    """
    found = Wired()
    with ExitStack() as stack:
        try:
            # An autopilot waits for nobody else.
            if wishes.mavlink is not None:
                link = _mavlink(wishes, detector)
                found.outputs.append(link.start())
                found.figures["mavlink"] = lambda: _mavlink_figures(link)
            _add_others(found, wishes, stop, stack)
            if wishes.http is not None:
                _add_monitor(found, wishes, wishes.http, detector)
            if wishes.record is not None:
                _add_recorder(found, wishes, wishes.record, detector, params)
            yield found
        except BaseException:
            close_all(found.outputs)
            raise


def close_all(outputs: Sequence[Output]) -> None:
    """Close outputs that no session closes."""
    for output in outputs:
        output.close()


def _add_others(found: Wired, wishes: Wishes, stop: Callable[[], None], stack: ExitStack) -> None:
    if wishes.udp is not None:
        address = host_and_port(wishes.udp, "--udp")
        datagrams = Datagrams(*address, Records(wishes.source), wishes.max_age_s)
        found.outputs.append(datagrams)
        found.figures["udp"] = lambda: {
            "sent": datagrams.sent,
            "failed": datagrams.failed,
            "too_old": datagrams.too_old,
        }
    if wishes.json_to is not None:
        if wishes.json_to == "-":
            descriptor = sys.stdout.fileno()
        else:
            check_output(Path(wishes.json_to), force=False)
            descriptor = os.open(wishes.json_to, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
            stack.callback(os.close, descriptor)
        lines = JsonLines(descriptor, Records(wishes.source), stop)
        found.outputs.append(lines)
        found.figures["json"] = lambda: {"written": lines.written, "dropped": lines.dropped}


def _add_monitor(found: Wired, wishes: Wishes, http: str, detector: Detector) -> None:
    from padstudio.live.outputs.watch import Watch
    from padstudio.live.stream.packet_shelf import PacketShelf
    from padstudio.web.monitor.serving import monitored

    address = host_and_port(http, "--http")
    watch, shelf = Watch(Records(wishes.source)), PacketShelf()
    found.outputs.append(watch)
    found.taps.append(shelf)
    found.monitor = lambda stats: monitored(address, watch, shelf, detector, stats)


def _mavlink(wishes: Wishes, detector: Detector) -> MavlinkOutput:
    from padstudio.live.outputs.mavlink.address import parse_address
    from padstudio.live.outputs.mavlink.output import MavlinkOutput
    from padstudio.live.outputs.mavlink.settings import MavlinkSettings, read_signing_key

    asked = wishes.mavlink
    assert asked is not None
    settings = dict(asked.settings)
    if asked.signing_key is not None:
        settings["signing_key"] = read_signing_key(asked.signing_key)
    if wishes.max_age_s is not None:
        settings["max_age_s"] = wishes.max_age_s
    if len(detector.pads) == 1:
        settings["pad_size_mm"] = detector.pad.size_mm
    address = parse_address(asked.address)
    whole = MavlinkSettings(address=address, mount=asked.mount, **settings)
    tell: Callable[[str], None] = (lambda text: None) if wishes.quiet else note
    return MavlinkOutput(whole, tell=tell)


def _mavlink_figures(link: MavlinkOutput) -> dict[str, Any]:
    stats = link.stats()
    return {
        "address": stats.address,
        "is_open": stats.is_open,
        "detail": stats.detail,
        "autopilot": stats.autopilot,
        "profile": stats.profile,
        "sent": stats.sent,
        "sent_unsynchronised": stats.sent_unsynchronised,
        "withheld": dict(stats.withheld),
    }


def _add_recorder(
    found: Wired, wishes: Wishes, base: Path, detector: Detector, params: dict[str, Any]
) -> None:
    from padstudio.live.recording.recorder import Recorder, new_folder, session_about

    base.mkdir(parents=True, exist_ok=True)
    about = session_about(detector.pads, detector.camera, wishes.source, detector.method, params)
    recorder = Recorder(new_folder(base), about)
    if not wishes.quiet:
        note(f"recording to {recorder.folder}")
    found.outputs.append(recorder)
    found.taps.append(recorder)

    def figures() -> dict[str, Any]:
        state = recorder.state
        return {
            "folder": os.fspath(recorder.folder),
            "phase": state.phase,
            "detail": state.detail,
            "segments": state.segments,
            "frames": state.frames,
            "bytes": state.bytes,
        }

    found.figures["recording"] = figures
