"""Frames in which one thing is wrong: it is what is said, with what to try."""

import numpy as np
import pytest
from reason_causes import CAMERAS, CAUSES, PADS, plain

from padstudio import Detector
from padstudio.errors import CameraMismatchError
from padstudio.simulate.sensor import Imaging

# Those below have tests of their own; these are read in spite of the dark, or of a slight bend.
ELSEWHERE = ("nothing", "turned", "print_scale", "underexposed", "warped")
SURE = [name for name in CAUSES if name not in ELSEWHERE]


def made(name, seed, pad="small", camera="vga"):
    """A picture, and a detector of the pad and camera that it is read with."""
    rng = np.random.default_rng([seed, *name.encode()])
    picture, *reading = CAUSES[name].make(rng, plain(rng, PADS[pad], CAMERAS[camera]), 1.0)
    return picture, Detector(*reading)


@pytest.mark.parametrize("name", SURE)
def test_what_is_wrong_is_said_first(name):
    picture, detector = made(name, 100)
    found = detector.detect(picture, reasons=True)
    said = found.warnings if found.ok else (found.failure, *found.failure.also)
    assert str(said[0].reason) == (CAUSES[name].reason or name)
    assert all(item.detail and item.advice for item in said)
    findings = found.to_record("frame.jpg").get("findings", [])
    assert len(findings) == len(found.warnings if found.ok else found.failure.also)


@pytest.mark.parametrize("pad", PADS)
def test_of_a_good_frame_nothing_is_said(pad):
    picture, detector = made("nothing", 101, pad)
    found = detector.detect(picture, reasons=True)
    assert found.ok
    assert found.warnings == ()
    assert "findings" not in found.to_record("frame.jpg")


def test_a_stretched_print_is_told_by_how_much():
    picture, detector = made("print_scale", 102, "large", "square")
    found = detector.detect(picture, reasons=True)
    assert str(found.warnings[0].reason) == "print_scale"
    assert "% too" in found.warnings[0].detail


def test_a_dark_frame_is_underexposed_and_not_black():
    dark = Imaging(brightness=0.004, full_well_e=1000.0)
    rng = np.random.default_rng(103)
    picture = plain(rng, PADS["small"], CAMERAS["vga"]).taken(rng, imaging=dark)
    failure = Detector(PADS["small"], CAMERAS["vga"]).detect(picture, reasons=True).failure
    assert failure is not None
    assert str(failure.reason) == "underexposed"


def test_bent_paper_is_said_of_a_pose():
    picture, detector = made("warped", 105, "large", "square")
    found = detector.detect(picture, reasons=True)
    assert found.flatness_mm is not None
    assert str(found.warnings[0].reason) == "warped"


def test_a_turned_picture_is_told_from_one_of_another_aspect():
    picture, detector = made("turned", 103)
    with pytest.raises(CameraMismatchError, match="turned by a quarter") as error:
        detector.detect(picture)
    assert error.value.detail["turned"]
    with pytest.raises(CameraMismatchError, match="of another aspect") as error:
        detector.detect(picture[:480])
    assert not error.value.detail["turned"]


def test_two_causes_are_both_named():
    picture, detector = made("another_pad", 104)
    found = detector.detect(np.ascontiguousarray(picture[..., :1].repeat(3, 2)), reasons=True)
    assert found.failure is not None
    said = [str(item.reason) for item in (found.failure, *found.failure.also)]
    assert said[0] == "monochrome"


def test_without_being_asked_nothing_is_looked_at_twice():
    picture, detector = made("covered", 100)
    failure = detector.detect(picture).failure
    assert failure is not None
    assert failure.also == ()


@pytest.mark.parametrize("name", ["covered", "cut_off", "nothing"])
def test_the_papers_method_gives_reasons_too(name):
    picture, dense = made(name, 100)
    detector = Detector(dense.pad, dense.camera, method="paper")
    found = detector.detect(picture, reasons=True)
    if name == "nothing":
        assert found.ok or "use the method dense" in found.failure.advice
    else:
        assert str(found.failure.reason) == name
