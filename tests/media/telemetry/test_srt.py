"""Telemetry in every form that DJI cameras are known to write."""

from __future__ import annotations

from pathlib import Path

import pytest
import videos

from padstudio.media.telemetry import columns, reading
from padstudio.media.telemetry.columns import Sample, Telemetry, TelemetryError
from padstudio.media.telemetry.srt import parse_srt, read_embedded

CUE = "1\n00:00:01,500 --> 00:00:01,533\n"

FORMS = {
    "mini 3": (
        '<font size="28">FrameCnt: 46, DiffTime: 33ms\n2023-06-01 12:00:00.123\n'
        "[iso: 100] [shutter: 1/1000.0] [fnum: 2.8] [ev: 0] [color_md : default] "
        "[focal_len: 24.00] [latitude: 22.5421] [longitude: 113.9572] "
        "[rel_alt: 1.300 abs_alt: 65.236] [ct: 5500] </font>",
        Sample(1.5, 46, 1.3, 65.236, 22.5421, 113.9572, "2023-06-01 12:00:00.123"),
    ),
    "mavic 2": (
        '<font size="36">SrtCnt : 46, DiffTime : 33ms\n2019-09-25 01:21:51,118,697\n'
        "[iso : 110] [shutter : 1/200.0] [fnum : 280] [latitude : 60.608553] "
        "[longtitude : -1.963763] [altitude: 1927.799987] </font>",
        Sample(1.5, 46, None, 1927.799987, 60.608553, -1.963763, "2019-09-25 01:21:51,118"),
    ),
    "mini 2": (
        "F/2.8, SS 206.14, ISO 150, EV 0, GPS (-122.3699, 37.8166, 15), D 224.21m, H 6.00m, "
        "H.S 5.10m/s, V.S -0.20m/s",
        Sample(1.5, None, 6.0, None, 37.8166, -122.3699),
    ),
    "phantom 4 rtk": (
        "F/3.2, SS 1000, ISO 100, EV 0, GPS (8.6499, 53.2665, 15), D 1.97m, H -1.20m, "
        "F.PRY (1.9°, -3.7°, 10.1°), G.PRY (-15.2°, 0.0°, 10.4°)",
        Sample(1.5, None, -1.2, None, 53.2665, 8.6499),
    ),
    "mavic pro": (
        "HOME(149.0251,-20.2532) 2017.08.05 14:11:51\nGPS(149.0251,-20.2533,16) BAROMETER:1.9\n"
        "ISO:100 Shutter:60 EV: Fnum:2.2",
        Sample(1.5, None, 1.9, None, -20.2533, 149.0251, "2017.08.05 14:11:51"),
    ),
    "matrice 300": (
        "2022.06.21 16:06:17\nGPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M",
        Sample(1.5, None, 0.3, 0.0, 36.6146, -6.112, "2022.06.21 16:06:17"),
    ),
    "phantom 3": (
        "HOME(W: 96.123, N: 43.001) 2015-11-02 10:20:30\nGPS(W: 96.125, N: 43.002, 715.94m) "
        "Hb: 2.4 Hs: 2.0",
        Sample(1.5, None, 2.4, 715.94, 43.002, -96.125, "2015-11-02 10:20:30"),
    ),
    "no fix": (
        "[latitude: 0.000000] [longitude: 0.000000] [rel_alt: 3.100 abs_alt: 3.1]",
        Sample(1.5, None, 3.1, 3.1),
    ),
}


@pytest.mark.parametrize("name", FORMS)
def test_forms(name: str) -> None:
    text, expected = FORMS[name]
    found = parse_srt(CUE + text + "\n\n")
    assert found.samples == (expected,)
    assert found.unread == 0


def test_a_file_of_many_subtitles_in_windows_lines() -> None:
    cues = [
        f"{n + 1}\r\n00:00:{n // 10:02},{n % 10}00 --> 00:00:09,000\r\n"
        f"[rel_alt: {n}.0 abs_alt: 5]\r\n\r\n"
        for n in range(30)
    ]
    found = parse_srt("".join(cues))
    assert [sample.time_s for sample in found.samples] == pytest.approx([n / 10 for n in range(30)])
    assert [sample.height_m for sample in found.samples] == [float(n) for n in range(30)]


def test_subtitles_of_other_forms_are_counted() -> None:
    found = parse_srt(CUE + "hello\n\n2\n00:00:02,000 --> 00:00:03,000\nH 4.0m\n")
    assert (len(found.samples), found.unread) == (1, 1)


@pytest.mark.parametrize("digits", [10, 400, 5000])
def test_numbers_of_any_length_are_no_fault(digits: int) -> None:
    many = "9" * digits
    with pytest.raises(TelemetryError):
        parse_srt(f"1\n{many}:00:00,000 --> 00:00:01,000\nH 4.0m\n")
    found = parse_srt(f"1\n00:00:00,000 --> {many}:00:01,000\nH 4.0m\n\n{CUE}H 5.0m\n")
    assert [sample.height_m for sample in found.samples] == [5.0]
    found = parse_srt(f"1\n00:00:00,000 --> 00:00:01,000\nFrameCnt: {many}\nH 4.0m\n")
    assert [sample.frame for sample in found.samples] == [None]


@pytest.mark.parametrize("text", ["", "a text", CUE + "Never gonna give you up\n"])
def test_what_is_no_telemetry_is_refused(text: str) -> None:
    with pytest.raises(TelemetryError) as caught:
        parse_srt(text)
    assert caught.value.error_code == "invalid_telemetry"


def test_files_are_read_whatever_their_encoding(tmp_path: Path) -> None:
    path = tmp_path / "a.srt"
    path.write_bytes(b"\xef\xbb\xbf" + CUE.encode() + "H 2.0m, 10°".encode("latin-1"))
    assert reading.read(str(path))["height_m"] == [2.0]


def test_heights_between_samples() -> None:
    told = columns.to_dict(
        Telemetry((Sample(1.0, height_m=10.0), Sample(2.0), Sample(3.0, height_m=14.0)))
    )
    assert columns.height_at(told, [0.5, 1.0, 2.5, 3.0, 3.1]) == [None, 10, 13, 14, None]
    at_sea = (Sample(1.0, altitude_m=410.0), Sample(3.0, altitude_m=414.0))
    told = columns.to_dict(Telemetry(at_sea))
    assert columns.height_at(told, [2.0, 4.0]) == [412, None]
    empty = columns.to_dict(Telemetry((Sample(1.0),)))
    assert columns.height_at(empty, [1.0]) == [None]


BARE = {
    "by the form": (
        "GPS(47.100001,8.200001,469.800) BAROMETER(12.4) HOME(47.100000,8.200000)",
        Sample(1.5, None, 12.4, 469.8, 47.100001, 8.200001),
    ),
    "by range, against the form": (
        "GPS(-122.3699,37.8166,469.800) BAROMETER(12.4)",
        Sample(1.5, None, 12.4, 469.8, 37.8166, -122.3699),
    ),
    "by range alone": (
        "GPS(37.8166,-122.3699)",
        Sample(1.5, None, None, None, 37.8166, -122.3699),
    ),
    "feet": (
        "F/2.8, GPS (8.2, 47.1, 15), D 24.5ft, H 20.0ft, H.S 0.00mph",
        Sample(1.5, None, 20 * 0.3048, None, 47.1, 8.2),
    ),
    "decimal comma": (
        "[latitude: 47,1] [longitude: 8,2] [rel_alt: 1,300 abs_alt: 132,860]",
        Sample(1.5, None, 1.3, 132.86, 47.1, 8.2),
    ),
    "autel": (
        "GPS(W: 8.2001, N: 47.1001, 469.57m) ReH:12",
        Sample(1.5, None, 12.0, 469.57, 47.1001, -8.2001),
    ),
}


@pytest.mark.parametrize("name", BARE)
def test_which_number_is_the_latitude(name: str) -> None:
    text, expected = BARE[name]
    assert parse_srt(CUE + text + "\n\n").samples == (expected,)


def test_one_sample_beyond_the_poles_tells_the_order_of_all() -> None:
    text = CUE + "GPS(80.0, 10.0)\n\n2\n00:00:02,000 --> 00:00:03,000\nGPS(100.0, 10.0)\n"
    found = parse_srt(text).samples
    assert [(each.latitude_deg, each.longitude_deg) for each in found] == [(10, 80), (10, 100)]


@pytest.mark.parametrize(
    "text", ["GPS(47.1, 8.2)", "GPS(47.1, 8.2) H 2.0m", "GPS(100.0, 8.2)\n GPS(8.2, 100.0)"]
)
def test_an_order_that_nothing_tells_is_refused(text: str) -> None:
    cues = "".join(CUE + line + "\n\n" for line in text.splitlines())
    with pytest.raises(TelemetryError, match="nothing tells which number is the latitude"):
        parse_srt(cues)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("head", ["1\n", "", "WEBVTT\n\n"])
def test_heads_and_encodings(tmp_path: Path, encoding: str, head: str) -> None:
    path = tmp_path / "a.srt"
    text = head + "00:00:01.500 --> 00:00:01.533\n[rel_alt: 1.5 abs_alt: 3]\n"
    path.write_bytes(text.encode(encoding))
    assert reading.read(str(path))["height_m"] == [1.5]


@pytest.mark.parametrize(("name", "codec"), [("a.mp4", "mov_text"), ("a.mkv", "subrip")])
def test_telemetry_inside_a_video(name: str, codec: str, tmp_path: Path) -> None:
    path = videos.write_with_subtitles(
        tmp_path / name, codec, [f"[rel_alt: {n}.5 abs_alt: 40.0]" for n in range(10)]
    )
    found = read_embedded(str(path))
    assert found is not None
    assert [sample.height_m for sample in found.samples] == [n + 0.5 for n in range(10)]
    times = [sample.time_s for sample in found.samples]
    assert times == pytest.approx([n / 25 for n in range(10)])


def test_a_video_without_telemetry(tmp_path: Path) -> None:
    assert read_embedded(str(videos.write(tmp_path / "a.mp4", 2))) is None


@pytest.mark.parametrize(
    ("text", "height_m", "altitude_m"),
    [
        ("[rel_alt: 32.8ft abs_alt: 100 ft]", 9.99744, 30.48),
        ("GPS(8.2001,47.1001,16) BAROMETER:10 feet", 3.048, None),
        ("GPS(47.1,8.2,469.8) BAROMETER(12.4m)", 12.4, 469.8),
        ("GPS(47.1,8.2,100ft) BAROMETER(10ft)", 3.048, 30.48),
        ("GPS(W: 8.2, N: 47.1, 1000FT) ReH:10FT", 3.048, 304.8),
        ("[rel_alt: 1.5e1 abs_alt: 2.5E-1]", 15, 0.25),
        ("[rel_alt: 1.2 abs_alt: 1,432.860]", 1.2, None),
    ],
)
def test_units_and_whole_numbers(text: str, height_m: float, altitude_m: float | None) -> None:
    [sample] = parse_srt(CUE + text + "\n\n").samples
    assert sample.height_m == pytest.approx(height_m, abs=1e-9)
    assert sample.altitude_m == (altitude_m and pytest.approx(altitude_m, abs=1e-9))
