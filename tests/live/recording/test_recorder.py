"""What is recorded is the stream as it came, and a line for each of its frames."""

from __future__ import annotations

import itertools
from pathlib import Path

import av
import numpy as np
import pytest
from live_sessions import (
    NOTHING,
    OPTIONS,
    lines_of,
    packets_of,
    play,
    recorder,
    session_of,
    units,
)
from videos import number_of, picture, write

from padstudio.errors import ConflictError
from padstudio.live.recording.options import RecordingOptions, RecordingState
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.report import LiveReport
from padstudio.media.images import decode
from padstudio.media.video_index import read_index

#: Codec, container, frames that others lie between.
STREAMS = [
    pytest.param("libx264", "ts", 0, id="h264"),
    pytest.param("libx264", "ts", 2, id="h264 with frames that wait for later ones"),
    pytest.param("libx264", "mp4", 0, id="h264 framed by lengths"),
    pytest.param("libx265", "ts", 0, id="h265"),
    pytest.param("mjpeg", "mkv", 0, id="mjpeg"),
]


MJPEG = ("mjpeg", "mkv", 0)


def stream(folder: Path, codec: str, suffix: str, b_frames: int, frames: int = 60) -> Path:
    pixel_format = "yuvj420p" if codec == "mjpeg" else "yuv420p"
    # Times as a camera keeps them that is not quite steady.
    times = [40 * number + 7 * (number % 3) for number in range(frames)]
    return write(
        folder / f"stream.{suffix}",
        frames,
        codec=codec,
        b_frames=b_frames,
        pixel_format=pixel_format,
        times_ms=times,
        options={"strict": "unofficial"} if codec == "mjpeg" else None,
    )


@pytest.mark.parametrize(("codec", "suffix", "b_frames"), STREAMS)
def test_packets_are_the_streams_own_and_timed_by_it(
    tmp_path: Path, codec: str, suffix: str, b_frames: int
) -> None:
    source = stream(tmp_path, codec, suffix, b_frames)
    into = recorder(tmp_path / "kept", RecordingOptions(segment_s=0.7, least_free_bytes=0))
    play(source, into)
    into.close()
    sent = packets_of(source)
    segments = session_of(tmp_path / "kept")["segments"]
    assert len(segments) >= 3
    kept = []
    for segment in segments:
        path = tmp_path / "kept" / segment["video"]
        first = segment["first_pts"]
        assert packets_of(path)[0][3], "a segment begins where decoding can"
        kept += [
            (data, pts + first, dts + first, key)
            for data, pts, dts, key in packets_of(path)
            if pts is not None and dts is not None
        ]
        with av.open(str(path)) as container:
            assert [segment["time_base"][1]] == [container.streams.video[0].time_base.denominator]
    assert [packet[1:] for packet in kept] == [packet[1:] for packet in sent]
    for ours, theirs in zip(kept, sent, strict=True):
        assert units(ours[0], codec, True) == units(theirs[0], codec, suffix == "mp4")


@pytest.mark.parametrize(("codec", "suffix", "b_frames"), STREAMS)
def test_every_frame_decodes_and_has_its_line(
    tmp_path: Path, codec: str, suffix: str, b_frames: int
) -> None:
    source = stream(tmp_path, codec, suffix, b_frames)
    into = recorder(tmp_path / "kept", RecordingOptions(segment_s=0.7, least_free_bytes=0))
    dropped = {3, 4, 5, 21, 59}
    play(source, into, is_read=lambda number: number not in dropped)
    into.close()
    place, start_s = 0, 0.0
    for segment in session_of(tmp_path / "kept")["segments"]:
        video = tmp_path / "kept" / segment["video"]
        index = read_index(str(video))
        assert (segment["first_frame"], segment["start_s"]) == (place, start_s)
        assert (segment["frames"], segment["duration_s"]) == (
            index.info.frames,
            index.info.duration_s,
        )
        lines = lines_of(tmp_path / "kept" / segment["poses"])
        assert [line["pts"] for line in lines] == index.pts.tolist()
        times = start_s + index.times_s()
        np.testing.assert_allclose([line["time_s"] for line in lines], times, rtol=0, atol=1e-12)
        with av.open(str(video)) as container:
            shown = [
                number_of(frame.to_ndarray(format="bgr24")) for frame in container.decode(video=0)
            ]
        assert shown == [line["frame"] for line in lines] == list(range(place, place + len(lines)))
        for line in lines:
            is_dropped = line["frame"] in dropped
            assert line["source"] == segment["video"]
            assert line["reason"] == ("dropped_live" if is_dropped else "no_edges")
            assert ("number" in line["live"]) is not is_dropped
            assert is_dropped or line["live"]["number"] == line["frame"]
        place, start_s = place + len(lines), start_s + index.info.duration_s
    assert place == 60


def test_a_recording_begins_at_a_keyframe(tmp_path: Path) -> None:
    source = stream(tmp_path, "libx264", "ts", 0)
    into = recorder(tmp_path / "kept")
    with av.open(str(source)) as container:
        video = container.streams.video[0]
        into.opened(video, 1)
        # The button was pressed behind the first keyframe.
        for packet in itertools.islice(container.demux(video), 4, None):
            if packet.size:
                into.packet(packet, 0.0)
    into.close()
    first = packets_of(tmp_path / "kept" / "0001.mp4")
    assert len(first) == 50
    assert first[0][3]


def test_connections_are_segments_of_their_own(tmp_path: Path) -> None:
    small = write(tmp_path / "small.ts", 20, b_frames=0)
    large = write(tmp_path / "large.ts", 20, b_frames=0, size=(384, 256))
    into = recorder(tmp_path / "kept")
    play(small, into, connection=1)
    play(large, into, connection=2, first_number=20)
    into.close()
    session = session_of(tmp_path / "kept")
    assert [segment["size_px"] for segment in session["segments"]] == [[192, 128], [384, 256]]
    assert [each["connection"] for each in session["connections"]] == [1, 2]
    lines = [
        line
        for segment in session["segments"]
        for line in lines_of(tmp_path / "kept" / segment["poses"])
    ]
    # Times of both connections are the same on the stream's own clock.
    assert [line["live"]["number"] for line in lines] == list(range(40))


def test_a_clock_that_jumps_ends_the_segment(tmp_path: Path) -> None:
    for jump_ms in (-400, 60_000):
        folder = tmp_path / str(jump_ms)
        folder.mkdir()
        source = write(folder / "s.ts", 40, b_frames=0)
        into = recorder(folder / "kept")
        with av.open(str(source)) as container:
            video = container.streams.video[0]
            into.opened(video, 1)
            for number, packet in enumerate(container.demux(video)):
                if not packet.size:
                    continue
                if number >= 25:
                    packet.pts += 90 * jump_ms
                    packet.dts += 90 * jump_ms
                into.packet(packet, 0.0)
        into.close()
        frames = [segment["frames"] for segment in session_of(folder / "kept")["segments"]]
        assert frames == [25, 10], "what comes before the next keyframe cannot be decoded"


def test_pictures_without_times_are_timed_as_they_arrive(tmp_path: Path) -> None:
    source = tmp_path / "s.mjpeg"
    # One picture after the other, as cameras send them by HTTP.
    source.write_bytes(b"".join(data for data, *_ in packets_of(stream(tmp_path, *MJPEG))))
    into = recorder(tmp_path / "kept")
    arrivals = [50.0, 50.031, 50.2, 50.201, 52.75]
    with av.open(str(source), format="mjpeg") as container:
        video = container.streams.video[0]
        into.opened(video, 1)
        packets = (packet for packet in container.demux(video) if packet.size)
        for number, (packet, time_s) in enumerate(zip(packets, arrivals, strict=False)):
            into.packet(packet, time_s)
            frame = LiveFrame(number, picture(0), time_s, time_s, time_s, connection=1)
            into.take(LiveReport(frame, NOTHING, time_s))
    into.close()
    lines = lines_of(tmp_path / "kept" / "0001.jsonl")
    found = [line["time_s"] for line in lines]
    np.testing.assert_allclose(found, np.subtract(arrivals, 50), atol=1e-6)
    assert [line["live"]["number"] for line in lines] == [0, 1, 2, 3, 4]


def test_frames_of_a_page_come_one_by_one(tmp_path: Path) -> None:
    import cv2

    into = recorder(tmp_path / "kept")
    # As a busy page sends them.
    times = [10.0, 10.031, 10.2, 10.201, 12.75]
    for number, time_s in enumerate(times):
        done, data = cv2.imencode(".jpg", picture(number))
        assert done
        into.frame_bytes(data.tobytes(), time_s, 100.0 + time_s, connection=3)
        frame = LiveFrame(number, picture(number), time_s, time_s, time_s, connection=3)
        if number != 2:
            into.take(LiveReport(frame, NOTHING, time_s + 0.02))
    done, other = cv2.imencode(".jpg", picture(5, 384, 256))
    into.frame_bytes(other.tobytes(), 13.0, 113.0, connection=3)
    into.close()
    session = session_of(tmp_path / "kept")
    assert [segment["frames"] for segment in session["segments"]] == [5, 1]
    lines = lines_of(tmp_path / "kept" / "0001.jsonl")
    found = [line["time_s"] for line in lines]
    np.testing.assert_allclose(found, np.subtract(times, 10), atol=1e-6)
    reasons = [line["reason"] for line in lines]
    assert reasons == ["no_edges", "no_edges", "dropped_live", "no_edges", "no_edges"]
    assert lines[0]["live"]["latency_ms"] == pytest.approx(20)
    packets = packets_of(tmp_path / "kept" / "0001.mp4")
    assert [number_of(decode(data)) for data, *_ in packets] == list(range(5))
    # Gaps of seconds are the sender's, and a size of its own is a segment of its own.
    assert read_index(str(tmp_path / "kept" / "0002.mp4")).info.shown_size == (384, 256)


def test_other_codecs_are_refused_by_name_and_the_next_stream_is_taken(tmp_path: Path) -> None:
    states: list[RecordingState] = []
    into = recorder(tmp_path / "kept", told=states.append)
    play(write(tmp_path / "s.webm", 10, codec="libvpx-vp9", b_frames=0), into, connection=1)
    play(write(tmp_path / "s.ts", 10, b_frames=0), into, connection=2)
    into.close()
    refused = next(state for state in states if state.phase == "refused")
    assert refused.code == "unrecordable_codec"
    assert "vp9" in refused.detail
    assert "MJPEG" in refused.detail
    assert [segment["frames"] for segment in session_of(tmp_path / "kept")["segments"]] == [10]


def test_raw_pictures_are_refused_with_the_way_out(tmp_path: Path) -> None:
    states: list[RecordingState] = []
    into = recorder(tmp_path / "kept", told=states.append)
    path = write(tmp_path / "s.avi", 4, codec="rawvideo", b_frames=0)
    play(path, into)
    into.close()
    assert "input_format=mjpeg" in next(s.detail for s in states if s.phase == "refused")


@pytest.mark.parametrize(
    ("address", "kept"),
    [
        ("rtsp://pilot:s3cret@10.0.0.2:554/live", "rtsp://pilot@10.0.0.2:554/live"),
        ("http://cam/stream?user=a&password=s3cret&x=1", "http://cam/stream?user=a&password=…&x=1"),
        ("udp://@:5600", "udp://@:5600"),
        ("/dev/video0", "/dev/video0"),
    ],
)
def test_no_password_is_kept(tmp_path: Path, address: str, kept: str) -> None:
    into = recorder(tmp_path / "kept", source=address)
    into.close()
    assert session_of(tmp_path / "kept")["source"] == kept
    assert all(b"s3cret" not in path.read_bytes() for path in (tmp_path / "kept").iterdir())


def test_a_folder_with_something_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ConflictError, match="not empty"):
        recorder(tmp_path, OPTIONS)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
