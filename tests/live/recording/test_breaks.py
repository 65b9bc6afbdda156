"""Whatever ends a recording, what is there is whole."""

from __future__ import annotations

import errno
import io
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import av
import pytest
from live_sessions import OPTIONS, lines_of, play, recorder, session_of
from videos import number_of, write

from padstudio.errors import StudioError
from padstudio.live.recording import whole_file
from padstudio.live.recording.options import RecordingOptions, RecordingState
from padstudio.media.video_index import read_index

_SUPPORT = Path(__file__).parents[2] / "support"
_PLAYER = """
import sys, time
from pathlib import Path
from live_sessions import play, recorder
from padstudio.live.recording.options import RecordingOptions

folder, source, plays = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
into = recorder(folder, RecordingOptions(segment_s=1.0, least_free_bytes=0))
played = 0
while played != plays:
    play(source, into, connection=played)
    played += 1
    # As fast as the disk takes it, and no faster: nothing is dropped.
    while into.state.phase != "stopped" and into._held:
        time.sleep(0.001)
time.sleep(600)
"""


@contextmanager
def player(folder: Path, source: Path, plays: int = -1) -> Iterator[subprocess.Popen[bytes]]:
    """A process that records a file again and again, or so often."""
    paths = os.pathsep.join([str(_SUPPORT), os.environ.get("PYTHONPATH", "")])
    process = subprocess.Popen(
        [sys.executable, "-c", _PLAYER, str(folder), str(source), str(plays)],
        env=os.environ | {"PYTHONPATH": paths},
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def wait_for(condition: Callable[[], bool], process: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + 120
    while not condition():
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.02)


def frames_in(path: Path) -> int:
    try:
        return read_index(str(path)).info.frames
    except (StudioError, OSError):
        return 0


def shown_in(path: Path) -> list[int]:
    """The numbers that a video's frames show."""
    with av.open(str(path)) as container:
        return [number_of(f.to_ndarray(format="bgr24")) for f in container.decode(video=0)]


def whole_lines(path: Path) -> list[dict[str, Any]]:
    """The lines of a poses file up to one that was cut short."""
    text = path.read_text()
    path.write_text(text[: text.rfind("\n") + 1])
    return lines_of(path)


def test_a_kill_costs_the_frame_that_was_being_written(tmp_path: Path) -> None:
    source = write(tmp_path / "s.ts", 24, b_frames=0)
    last = tmp_path / "kept" / "0003.mp4"
    with player(tmp_path / "kept", source, plays=3) as process:
        # Connections end here, and so do segments; the writer waits for more.
        wait_for(lambda: frames_in(last) == 24, process)
        process.send_signal(signal.SIGKILL)
    for number in (1, 2, 3):
        assert shown_in(tmp_path / "kept" / f"{number:04d}.mp4") == list(range(24))
    assert session_of(tmp_path / "kept")["ended"] is None


def test_a_kill_amid_writing_leaves_segments_and_lines_that_belong_together(
    tmp_path: Path,
) -> None:
    source = write(tmp_path / "s.ts", 60, b_frames=2)
    with player(tmp_path / "kept", source) as process:
        wait_for(lambda: (tmp_path / "kept" / "0007.jsonl").exists(), process)
        process.send_signal(signal.SIGKILL)
    session = session_of(tmp_path / "kept")
    assert len(session["segments"]) >= 6
    for place, segment in enumerate(session["segments"]):
        path = tmp_path / "kept" / segment["video"]
        is_last = place == len(session["segments"]) - 1
        if is_last and not frames_in(path):
            continue
        index = read_index(str(path))
        assert index.info.frames == segment["frames"] or is_last
        shown = shown_in(path)
        lines = whole_lines(tmp_path / "kept" / segment["poses"])
        known = index.pts.tolist()
        for line in lines:
            # The last frame may be read already and not be written yet.
            if line["pts"] in known:
                number = shown[known.index(line["pts"])]
                assert line["live"]["number"] == number
            else:
                assert is_last
                assert line["pts"] > known[-1]


class Disk:
    """Takes so many bytes in all files together, or waits while it is blocked."""

    def __init__(self, room: int | None = None) -> None:
        self.room = room
        self.is_free = threading.Event()
        self.is_free.set()

    def open(self, path: Path) -> Any:
        return _File(path, self)


class _File(io.FileIO):
    def __init__(self, path: Path, disk: Disk) -> None:
        super().__init__(path, "xb")
        self._disk = disk

    def write(self, data: Any) -> int:
        self._disk.is_free.wait()
        if self._disk.room is None:
            return super().write(data)
        # As a file system does, as much as there is room for, and then the fault.
        some = bytes(data)[: self._disk.room]
        self._disk.room -= len(some)
        if not some and data:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return super().write(some)


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    made = Disk()
    monkeypatch.setattr(whole_file, "open_new", made.open)
    return made


# In a header, amid frames, at a boundary of segments or in a line: anywhere.
@pytest.mark.parametrize("room", [0, 700, 1500, 6_001, 13_002, 20_003, 27_004])
def test_a_full_disk_ends_the_recording_and_keeps_what_is_whole(
    tmp_path: Path, disk: Disk, room: int
) -> None:
    source = write(tmp_path / "s.ts", 60, b_frames=2)
    disk.room = room
    states: list[RecordingState] = []
    options = RecordingOptions(segment_s=0.7, least_free_bytes=0)
    into = recorder(tmp_path / "kept", options, states.append)
    assert play(source, into) == 60, "the session goes on"
    into.close()
    assert (into.state.phase, into.state.code) == ("stopped", "disk_full")
    assert "what is there is kept" in states[-1].detail
    session = session_of(tmp_path / "kept")
    assert session["ended"]["code"] == "disk_full"
    shown: list[int] = []
    for segment in session["segments"]:
        path = tmp_path / "kept" / segment["video"]
        if not path.exists():
            assert segment is session["segments"][-1]
            continue
        if frames_in(path):
            shown += shown_in(path)
        poses = tmp_path / "kept" / segment["poses"]
        if poses.exists():
            assert poses.read_bytes().endswith(b"\n")
            lines_of(poses)
    # Frames between may be missing at the end, as others were written before them.
    assert len(set(shown)) == len(shown)
    assert shown == sorted(shown)


def test_a_slow_disk_costs_packets_never_the_session(tmp_path: Path, disk: Disk) -> None:
    source = write(tmp_path / "s.ts", 60, b_frames=0)
    options = RecordingOptions(held_bytes=3_000, least_free_bytes=0)
    into = recorder(tmp_path / "kept", options)

    def block(packet: int) -> None:
        if packet == 45:
            disk.is_free.set()
        if not 12 <= packet < 45:
            # Nothing waits while the disk is quick.
            end = time.monotonic() + 60
            while into._held and time.monotonic() < end:
                time.sleep(0.001)
        if packet == 12:
            disk.is_free.clear()

    assert play(source, into, between=block) == 60
    into.close()
    session = session_of(tmp_path / "kept")
    first, second = session["segments"]
    assert session["dropped"]["packets"] == 60 - first["frames"] - second["frames"] > 0
    assert into.state.packets_dropped == session["dropped"]["packets"]
    for segment in (first, second):
        lines = lines_of(tmp_path / "kept" / segment["poses"])
        shown = shown_in(tmp_path / "kept" / segment["video"])
        numbers = [line["live"].get("number") for line in lines]
        assert all(number in (None, seen) for number, seen in zip(numbers, shown, strict=True))
    assert shown_in(tmp_path / "kept" / second["video"])[0] % 10 == 0, "a keyframe"


def test_a_disk_with_little_room_is_left_alone(tmp_path: Path) -> None:
    into = recorder(tmp_path / "kept", RecordingOptions(least_free_bytes=1 << 60))
    play(write(tmp_path / "s.ts", 10, b_frames=0), into)
    into.close()
    assert (into.state.phase, into.state.code) == ("stopped", "disk_low")
    assert session_of(tmp_path / "kept")["segments"] == []


def test_a_recording_is_no_larger_than_it_may_be(tmp_path: Path) -> None:
    options = RecordingOptions(segment_s=0.4, most_bytes=12_000, least_free_bytes=0)
    into = recorder(tmp_path / "kept", options)
    play(write(tmp_path / "s.ts", 200, b_frames=0), into)
    into.close()
    assert (into.state.phase, into.state.code) == ("stopped", "recording_full")
    kept = [path.stat().st_size for path in (tmp_path / "kept").glob("0*")]
    assert 12_000 <= sum(kept) < 12_000 + 3 * max(kept)
    session = session_of(tmp_path / "kept")
    for segment in session["segments"]:
        assert frames_in(tmp_path / "kept" / segment["video"]) == segment["frames"]


def test_closing_twice_is_closing(tmp_path: Path) -> None:
    into = recorder(tmp_path / "kept", OPTIONS)
    into.close()
    into.close()
    assert into.state.phase == "closed"
