from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from places import FOOTAGE

from padstudio.errors import CameraMismatchError, ImageError
from padstudio.workers.detection import THUMBNAIL_WIDTH_PX, Job, analyze, save_picture, thumbnail_of

STILL = "a_blur1_450.jpg"


def _job(pictures: Path | None = None, image: bytes | None = None) -> Job:
    return Job(
        image=(FOOTAGE / "stills" / STILL).read_bytes() if image is None else image,
        source=STILL,
        pads=((FOOTAGE / "pad_a.json").read_text(),),
        camera=(FOOTAGE / "camera_drone_2k7.yaml").read_text(),
        method="dense",
        max_pixels=20_000_000,
        pictures=pictures,
    )


def test_a_real_still_with_its_stages(tmp_path: Path) -> None:
    answer = analyze(_job(tmp_path))
    result = answer["results"][0]
    assert (result["status"], result["source"]) == ("ok", STILL)
    width, height = answer["image"]["width"], answer["image"]["height"]
    assert answer["camera_scale"] == pytest.approx(width / 2720)
    json.dumps(answer)
    names = [stage["picture"] for stage in answer["stages"] if stage["picture"]]
    assert {"red-edges.png", "red-lines.png", "choose.png"} <= set(names)
    assert {(s["name"], s["channel"]) for s in answer["stages"]} >= {("edges", "blue")}
    for name in (*names, "result.png"):
        image = cv2.imread(str(tmp_path / name), cv2.IMREAD_UNCHANGED)
        small = cv2.imread(str(tmp_path / thumbnail_of(name)), cv2.IMREAD_UNCHANGED)
        assert image.shape[1] / image.shape[0] == pytest.approx(width / height, rel=0.02)
        assert small.shape[1] == min(THUMBNAIL_WIDTH_PX, image.shape[1])


def test_colours_are_unmixed_by_the_pads_own_mixture_unless_told_otherwise() -> None:
    pad = json.loads(_job().pads[0])
    # A mixture that the footage's printer does not have turns red and blue round.
    pad["crosstalk"] = [[0, 0, 1], [0, 1, 0], [1, 0, 0]]
    turned = replace(_job(), pads=(json.dumps(pad),))
    plain = analyze(_job())["results"][0]["position_mm"]
    assert analyze(turned)["results"][0].get("position_mm") != plain
    assert analyze(replace(turned, unmix=False))["results"][0]["position_mm"] == plain


def test_without_a_trace_nothing_is_written() -> None:
    answer = analyze(_job())
    assert answer["stages"] is None
    assert answer["results"][0]["status"] == "ok"


def test_finding_nothing_is_an_answer(tmp_path: Path) -> None:
    grey = cv2.imencode(".png", np.full((1530, 2720), 90, np.uint8))[1].tobytes()
    result = analyze(_job(tmp_path, grey))["results"][0]
    assert result["status"] == "failed"
    assert result["reason"]
    assert result["detail"]
    assert (tmp_path / "result.png").exists()


def test_pictures_that_do_not_fit(tmp_path: Path) -> None:
    square = cv2.imencode(".png", np.zeros((400, 400), np.uint8))[1].tobytes()
    with pytest.raises(CameraMismatchError):
        analyze(_job(tmp_path, square))
    with pytest.raises(ImageError):
        analyze(_job(tmp_path, b"x"))
    assert not list(tmp_path.iterdir())


def test_thumbnails_of_thin_lines_stay_bright(tmp_path: Path) -> None:
    picture = np.zeros((1530, 2720, 3), np.uint8)
    picture[::50], picture[:, ::50] = 255, 255
    for is_thin in (False, True):
        save_picture(tmp_path, f"{is_thin}.png", picture, is_thin=is_thin)
    small, plain = (
        cv2.imread(str(tmp_path / f"small-{is_thin}.webp"), cv2.IMREAD_GRAYSCALE)
        for is_thin in (True, False)
    )
    assert plain[:, 3:8].max() < 64
    assert small[:, 3:8].max(axis=0).min() > 200
    assert (small > 128).mean() > 0.2


def test_edges_are_drawn_for_a_thumbnail(tmp_path: Path) -> None:
    analyze(_job(tmp_path))
    small = cv2.imread(str(tmp_path / "small-red-edges.webp"), cv2.IMREAD_GRAYSCALE)
    assert (small > 128).mean() > 0.05
