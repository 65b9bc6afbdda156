"""Bundles: made, opened again, replayed, and refused where they are damaged."""

from __future__ import annotations

import contextlib
import io
import json
import warnings
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from places import ROOT
from typer.testing import CliRunner

from padstudio.arrays import YuvFrame
from padstudio.cli.program import app
from padstudio.errors import LimitError, StudioError
from padstudio.flights import batch
from padstudio.flights.bundles.around import fused_again
from padstudio.flights.bundles.contents import MANIFEST, ORIGINAL, pack
from padstudio.flights.bundles.making import Beside, RunFrame, Wish, bundle_run, bundle_still
from padstudio.flights.bundles.reading import unpack
from padstudio.flights.bundles.replay import differing, replay
from padstudio.flights.tasks.detectors import Recipe
from padstudio.media import images
from padstudio.resources import sample_folder

SAMPLES = sample_folder()
FOOTAGE = ROOT / "tests" / "footage"
PICTURE = SAMPLES / "height_450mm.jpg"


@pytest.fixture(scope="module")
def recipe():
    return Recipe((SAMPLES / "pad.json").read_text(), (SAMPLES / "camera.yaml").read_text())


@pytest.fixture(scope="module")
def frame():
    return images.read(PICTURE)


@pytest.fixture(scope="module")
def packed(recipe):
    return pack(bundle_still(recipe, PICTURE.read_bytes(), "a.jpg"))


def with_members(data, kind=zipfile.ZIP_STORED, **changed):
    """The same zip with members of other contents, or left out where None."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", kind) as archive:
        for name, content in (members | changed).items():
            if content is not None:
                archive.writestr(name, content)
    return written.getvalue()


def manifest_of(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return json.loads(archive.read(MANIFEST))


def test_a_still_reads_the_very_same(packed):
    opened = unpack(packed)
    assert opened.original == PICTURE.read_bytes()
    found = replay(opened)
    assert opened.result["status"] == "ok"
    assert found["same"], found["differences"]
    assert found["versions"] == []


def test_what_differs_is_told_with_versions(packed):
    manifest = manifest_of(packed)
    manifest["result"]["cells_read"] += 1
    manifest["versions"]["padstudio"] = "0.0.1"
    found = replay(unpack(with_members(packed, **{MANIFEST: json.dumps(manifest)})))
    assert not found["same"]
    assert [each["field"] for each in found["differences"]] == ["cells_read"]
    assert [each["name"] for each in found["versions"]] == ["padstudio"]


def test_rounding_is_no_difference():
    then = {"position_mm": [100.0, 0.0], "reason": "a", "cells_read": 12}
    assert differing(then, then | {"position_mm": [100.000_01, 1e-9]}) == []
    found = differing(then, then | {"position_mm": [100.001, 1e-3], "cells_read": 13})
    assert [each["field"] for each in found] == ["cells_read", "position_mm[0]", "position_mm[1]"]


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """The records of a run of the footage, and the pieces in which it was read."""
    pieces = batch.plan([FOOTAGE / "flights" / "landing.mp4"], flown_recipe())
    records = [record for piece in pieces for record in piece.task.run(lambda: False)]
    return pieces, records


def flown_recipe():
    pad, camera = FOOTAGE / "pad_a.json", FOOTAGE / "camera_drone_2k7.yaml"
    return Recipe(pad.read_text(), camera.read_text(), params='{"search": {"least_step": 0.5}}')


def run_frame(flown, number):
    pieces, records = flown

    def part(wanted, count):
        piece = next(each for each in pieces if wanted in each.numbers)
        end = piece.numbers.index(wanted) + 1
        return piece.task.part.between(0 if count is None else end - count, end)

    beside = tuple(
        Beside(by, part(number + by, 1), records[number + by])
        for by in (-1, 1)
        if 0 <= number + by < len(records)
    )
    return RunFrame(flown_recipe(), part(number, None), records[number], "1.0", beside)


# Amid what was followed; the first of the second piece; the last one.
@pytest.mark.parametrize("number", [17, 30, 59])
def test_a_run_frame_reads_as_the_run_did(flown, number):
    made = bundle_run(run_frame(flown, number), Wish("dense", "{}"))
    assert (made.expected is None) == (number == 30)
    assert differing(flown[1][number], made.result) == []
    # What the frame alone gives is another result, and told as such.
    assert made.alone.result["status"] == "ok"
    if number != 30:
        assert made.alone.result["position_mm"] != pytest.approx(made.result["position_mm"])
    opened = unpack(pack(made))
    assert opened.expected == made.expected or (
        opened.expected.to_dict() == made.expected.to_dict()
    )
    found = replay(opened)
    assert found["same"], found
    assert found["result"]["position_mm"] == pytest.approx(flown[1][number]["position_mm"])
    assert found["alone"]["position_mm"] == pytest.approx(made.alone.result["position_mm"])


def test_neighbours_are_the_frames_beside_to_the_bit(flown):
    pieces, records = flown
    opened = unpack(pack(bundle_run(run_frame(flown, 29), Wish("dense", "{}"))))
    parts = pieces[0].task.part.between(28, 29), pieces[1].task.part.between(0, 1)
    assert [each.offset for each in opened.neighbours] == [-1, 1]
    for part, neighbour, number in zip(parts, opened.neighbours, (28, 30), strict=True):
        (there,) = part.read(images.MAX_PIXELS)
        assert np.array_equal(neighbour.picture, there.bgr)
        assert differing(neighbour.result, records[number]) == []
    last = bundle_run(run_frame(flown, 59), Wish("dense", "{}"))
    assert [each.offset for each in last.neighbours] == [-1]


def test_what_a_run_said_otherwise_is_told_apart(flown):
    run = run_frame(flown, 17)
    other = replace(run, recorded={**run.recorded, "cells_read": 1})
    found = replay(unpack(pack(bundle_run(other, Wish("paper", "{}")))))
    assert not found["same"]
    assert found["differences"] == found["alone_differences"] == []
    assert [each["field"] for each in found["recorded_differences"]] == ["cells_read"]


def test_planes_come_back_exactly(recipe, frame):
    height, width = frame.shape[:2]
    planes = np.random.default_rng(3).integers(0, 256, (3, height, width + 8)).astype(np.uint8)
    half = (-(-height // 2), -(-width // 2))
    u, v = (np.ascontiguousarray(plane[: half[0], : half[1]]) for plane in planes[1:])
    yuv = YuvFrame(planes[0], u, v, width, "bt709", False, lambda: frame)
    made = bundle_still(recipe, PICTURE.read_bytes(), "a")
    made = replace(made, frame=yuv, original=None)
    back = unpack(pack(made)).frame
    assert isinstance(back, YuvFrame)
    assert np.array_equal(back.y, planes[0][:, :width])
    assert back.width == width
    assert np.array_equal(back.u, u)
    assert np.array_equal(back.v, v)
    assert np.array_equal(back.bgr, frame)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"../../evil.txt": b"x"}, "unknown_member"),
        ({MANIFEST: None}, "not_a_bundle"),
        ({MANIFEST: b"{}"}, "not_a_bundle"),
        ({MANIFEST: b"[" * 100_000}, "invalid_bundle"),
        ({"trace.json": b'{"stages": NaN}'}, "invalid_bundle"),
        ({"trace.json": b'{"stages": [{"name": 1, "channel": null}]}'}, "invalid_bundle"),
        ({"trace.json": b'{"stages": [1e999]}'}, "invalid_bundle"),
        ({"trace.json": b'{"stages": ["\\ud800"]}'}, "invalid_bundle"),
        ({"trace.json": b'{"stages": ["\\u0000"]}'}, "invalid_bundle"),
        ({"trace.json": b'{"stages": ' + b"[" * 30 + b"]" * 30 + b"}"}, "invalid_bundle"),
        ({"/etc/passwd": b"x"}, "unknown_member"),
        ({"frame.png/../../x": b"x"}, "unknown_member"),
        ({"trace.json": None}, "not_a_bundle"),
        ({"camera.yaml": None}, "invalid_bundle"),
        ({ORIGINAL: None}, "invalid_bundle"),
        ({"pad.json": b"{}"}, "invalid_pad_file"),
        ({"pad.json": None}, "invalid_bundle"),
        ({ORIGINAL: b"no picture"}, "not_an_image"),
        ({"camera.yaml": b"a: ["}, "invalid_camera_file"),
    ],
)
def test_odd_bundles_are_refused(packed, change, code):
    with pytest.raises(StudioError) as raised:
        unpack(with_members(packed, **change))
    assert raised.value.error_code == code


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"pad.json": None}, "lacks pad.json"),
        ({"camera.yaml": None}, "lacks camera.yaml"),
        ({"stills/0001.jpg": b"x"}, "a zip of stills as a flight"),
    ],
)
def test_what_is_amiss_with_a_bundle_is_said(packed, change, says):
    with pytest.raises(StudioError, match=says):
        unpack(with_members(packed, **change))


def test_a_bomb_is_not_unpacked(packed):
    with pytest.raises(LimitError) as raised:
        unpack(with_members(packed, zipfile.ZIP_DEFLATED, **{"trace.json": b" " * 30_000_000}))
    assert raised.value.error_code == "bundle_too_large"


def test_thousands_of_members_are_refused_by_the_directory_alone(packed):
    crowd = {f"{k}.txt": b"" for k in range(5000)}
    with pytest.raises(LimitError) as raised:
        unpack(with_members(packed, **crowd))
    assert raised.value.error_code == "too_many_members"


def test_a_directory_that_hides_its_length_is_refused(packed):
    data = bytearray(packed)
    # Readers ignore the counts of entries; a signature there must not hide the length behind.
    data[-10:-6] = (200_000_000).to_bytes(4, "little")
    data[-14:-10] = b"PK\x05\x06"
    with pytest.raises(LimitError) as raised:
        unpack(bytes(data))
    assert raised.value.error_code == "too_many_members"


def test_another_pad_gives_another_result_and_says_so(packed):
    pad = json.loads((SAMPLES / "pad.json").read_text())
    layer = pad["layers"][0]
    layer["cell_mm"] *= 1.01
    layer["codes"] = [row[::-1] for row in layer["codes"]]
    found = replay(unpack(with_members(packed, **{"pad.json": json.dumps(pad)})))
    assert not found["same"]
    assert "pad_id" in {each["field"] for each in found["differences"]}


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damage_is_an_error_of_ours_or_none(packed, data):
    damaged = bytearray(packed)
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(damaged) - 1))
        damaged[place] = data.draw(st.integers(0, 255))
    end = data.draw(st.one_of(st.just(len(damaged)), st.integers(0, len(damaged))))
    with contextlib.suppress(StudioError):
        unpack(bytes(damaged[:end]))


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    name=st.sampled_from(["reading", "method", "params", "planes", "expected", "result", "view",
                          "recorded", "recorded_version", "alone", "neighbours", "versions"]),
    value=st.recursive(st.none() | st.booleans() | st.integers() | st.text(max_size=5),
                       lambda each: st.lists(each, max_size=3)
                       | st.dictionaries(st.text(max_size=5), each, max_size=3), max_leaves=5),
)  # fmt: skip
def test_other_fields_are_an_error_of_ours_or_none(packed, name, value):
    manifest = manifest_of(packed) | {name: value}
    with contextlib.suppress(StudioError):
        unpack(with_members(packed, **{MANIFEST: json.dumps(manifest)}))


AROUND = {
    "fusion": "filter",
    "frame": 7,
    "frames": [
        {
            "source": "a", "frame": frame, "time_s": frame / 30, "status": "ok", "pad_id": "x",
            "position_mm": [0.0, 0.0, 500.0], "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0],
            "covariance": [1.0] * 21,
        }
        for frame in (6, 7)
    ],
}  # fmt: skip


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    name=st.sampled_from(list(AROUND["frames"][0])),
    value=st.none() | st.booleans() | st.integers() | st.text(max_size=5)
    | st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=21),
)  # fmt: skip
def test_other_frames_around_are_an_error_of_ours_or_none(packed, name, value):
    first, own = AROUND["frames"]
    text = json.dumps(AROUND | {"frames": [first | {name: value}, own]})
    manifest = manifest_of(packed)
    manifest["recorded"] = manifest["result"]
    members = {"around.json": text, MANIFEST: json.dumps(manifest)}
    with contextlib.suppress(StudioError):
        opened = unpack(with_members(packed, **members))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fused_again(opened.around, opened.around.records[1] | {"status": "ok"})


def test_the_command_line_bundles_and_replays(tmp_path):
    out = tmp_path / "a.zip"
    words = ["bundle", str(SAMPLES / "another_pad.jpg"), "--pad", str(SAMPLES / "pad.json")]
    words += ["--camera", str(SAMPLES / "camera.yaml"), "-o", str(out)]
    made = CliRunner().invoke(app, words)
    assert made.exit_code == 0, made.output
    said = CliRunner().invoke(app, ["replay", str(out)])
    assert said.exit_code == 0, said.output
    assert "the very same result" in said.output
    assert CliRunner().invoke(app, words).exit_code != 0


def test_the_command_line_bundles_a_frame_of_a_video(tmp_path, flown):
    out, video = tmp_path / "a.zip", str(FOOTAGE / "flights" / "landing.mp4")
    words = ["bundle", video, "--pad", str(FOOTAGE / "pad_a.json"), "--camera"]
    words += [str(FOOTAGE / "camera_drone_2k7.yaml"), "--param", "search.least_step=0.5"]
    assert CliRunner().invoke(app, [*words, "-o", str(out)]).exit_code == 2
    assert CliRunner().invoke(app, [*words, "-o", str(out), "--frame", "60"]).exit_code == 2
    made = CliRunner().invoke(app, [*words, "-o", str(out), "--frame", "45"])
    assert made.exit_code == 0, made.output
    opened = unpack(out.read_bytes())
    assert differing(flown[1][45], opened.result) == []
    assert [each.offset for each in opened.neighbours] == [-1, 1]
    # Bundles go to others: no folder of this machine.
    assert str(FOOTAGE) not in json.dumps(manifest_of(out.read_bytes()))
    said = CliRunner().invoke(app, ["replay", str(out), "--json"])
    assert said.exit_code == 0, said.output
    assert json.loads(said.stdout)["same"]
