"""Missing packets of H.264 are noticed by what those that came say."""

from __future__ import annotations

from pathlib import Path

import pytest
import videos
from hypothesis import given
from hypothesis import strategies as st

from padstudio.live.stream.continuity import Continuity


def packets_of(path: Path) -> list[list[bytes]]:
    """Units of each packet of an MP4 file, with start codes in place of lengths."""
    import av

    found: list[list[bytes]] = []
    with av.open(str(path)) as container:
        header = bytes(container.streams.video[0].codec_context.extradata or b"")
        for packet in container.demux(video=0):
            data, place, split = bytes(packet), 0, []
            while place < len(data):
                length = int.from_bytes(data[place : place + 4], "big")
                split.append(b"\0\0\0\1" + data[place + 4 : place + 4 + length])
                place += 4 + length
            found.append(split)
    # ISO/IEC 14496-15, 5.3.3.1: the first sequence parameters follow eight bytes.
    length = int.from_bytes(header[6:8], "big")
    found[0].insert(0, b"\0\0\0\1" + header[8 : 8 + length])
    return [split for split in found if split]


@pytest.fixture(scope="module", params=[0, 2])
def packets(
    tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> list[bytes]:
    path = tmp_path_factory.mktemp("video") / "a.mp4"
    videos.write(path, 40, b_frames=request.param, size=(640, 480))
    return [b"".join(split) for split in packets_of(path)]


def breaks(packets: list[bytes]) -> list[int]:
    continuity = Continuity("h264", b"")
    return [place for place, packet in enumerate(packets) if continuity.breaks(packet)]


def test_a_whole_stream_has_no_breaks(packets: list[bytes]) -> None:
    assert breaks(packets) == []
    assert breaks(packets[10:]) == []


def test_a_missing_frame_is_noticed_where_others_rest_on_it(packets: list[bytes]) -> None:
    referred = [place for place, packet in enumerate(packets) if packet[4] & 0x60]
    lost = next(place for place in referred[2:] if place % 10 not in (8, 9))
    assert breaks(packets[:lost] + packets[lost + 1 :])


def test_a_frame_without_its_first_slice_is_noticed(tmp_path: Path) -> None:
    path = videos.write(tmp_path / "a.mp4", 6, b_frames=0, options={"slices": "2"})
    split = packets_of(path)
    assert len(split[3]) == 2
    split[3] = split[3][1:]
    assert breaks([b"".join(units) for units in split]) == [3]


def test_parts_of_two_frames_in_one_packet_are_noticed(tmp_path: Path) -> None:
    path = videos.write(tmp_path / "a.mp4", 6, b_frames=0, options={"slices": "2"})
    split = packets_of(path)
    split[3:5] = [[split[3][0], split[4][1]]]
    assert 3 in breaks([b"".join(units) for units in split])


@pytest.mark.parametrize("codec", ["mjpeg", "vp9"])
def test_of_other_codecs_nothing_is_said(codec: str) -> None:
    assert not Continuity(codec, b"").breaks(b"\0\0\1\x65\x88")


@given(st.binary(max_size=40), st.binary(max_size=60), st.sampled_from(["h264", "hevc"]))
def test_no_bytes_are_too_strange(extradata: bytes, data: bytes, codec: str) -> None:
    units = b"".join(b"\0\0\1" + part for part in (data, b"\x67" + data, b"\x65" + data))
    continuity = Continuity(codec, extradata)
    for each in (data, units, units[::-1]):
        continuity.breaks(each)
