"""Disturbances in words: what they put on, and what they refuse."""

import numpy as np
import pytest

from padstudio.errors import SpecError
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.disturbances import WORDS, disturb, vibrations_of
from padstudio.simulate.lay.relief import Fold, Lift, Relief, Wave
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.looks import dress
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.response import RESPONSES
from padstudio.simulate.sensor import Imaging

PAD = Pad((Layer("red", 20.0, np.eye(20, dtype=np.uint8)),), window=3)
SCENE = Scene(pad=PAD)


def put(*words, seed=1):
    return disturb(SCENE, Imaging(), words, seed=seed)


def test_each_word_changes_its_own_part():
    scene, imaging = put(
        "fog=12", "mud=0.3", "faded=0.5", "sensor=nir", "readout=18", "exposure=4", "copy=500:20"
    )
    assert scene.fog.visibility_m == 12
    assert (scene.litter.kind, scene.litter.share) == ("mud", 0.3)
    assert scene.inks.red == Inks().faded(0.5).red
    assert imaging.response is RESPONSES["nir"]
    assert (imaging.readout_ms, imaging.exposure_ms) == (18, 4)
    assert (scene.neighbours[0].x_mm, scene.neighbours[0].turn_deg) == (500, 20)
    assert put() == (SCENE, Imaging())


def test_paper_bends_and_sheets_lie_as_given():
    bent, _ = put("waves=2:150", "fold=5:40", "lifted=12:80")
    assert isinstance(bent.lay, Relief)
    wave, fold, lift = bent.lay.bends
    assert (type(wave), type(fold), type(lift)) == (Wave, Fold, Lift)
    # The corner itself is lifted by what was asked for.
    corner = np.array([np.hypot(200.0, 200.0)])
    assert lift.height(corner) == pytest.approx(12.0)
    sheets, _ = put("tiles=4x3", "gap=2", "offset=1", "turn=0.5", "swaps=1", seed=7)
    assert sheets.lay == Tiles(
        columns=4, rows=3, gap_mm=2, offset_mm=1, turn_deg=0.5, swaps=1, seed=7
    )


def test_vibrations_are_drawn_by_the_seed():
    first, second = vibrations_of(["vibration=93:0.1+141:0.05", "fog=9"], seed=3)
    assert (first.frequency_hz, second.frequency_hz) == (93, 141)
    assert second.amplitude_deg == (0.05, 0.05, 0.05)
    assert vibrations_of(["vibration=93:0.1+141:0.05"], seed=3) == (first, second)
    assert vibrations_of(["vibration=93:0.1+141:0.05"], seed=4) != (first, second)
    assert vibrations_of(["fog=9"]) == ()


def test_a_word_overrides_the_look_s_own():
    scene, _ = dress(SCENE, "fog", words=["fog=77", "snow=0.1"])
    assert scene.fog.visibility_m == 77
    assert scene.litter.kind == "snow"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["rain=1"], "no disturbance 'rain'"),
        (["fog"], "give fog=METRES"),
        (["fog=thick"], "fog=thick is ill-formed"),
        (["fog=0"], r"0\.1 … 100000"),
        (["fog=9", "fog=8"], "given twice"),
        (["leaves=2"], r"0 … 0\.95"),
        (["leaves=0.1", "mud=0.1"], "already"),
        (["waves=3"], "give waves=MM:LENGTH"),
        (["gap=2"], "needs sheets"),
        (["tiles=4"], "give tiles=COLUMNSxROWS"),
        (["tiles=4x4", "waves=1:100"], "not both"),
        (["tiles=4x4", "swaps=1.5"], "ill-formed"),
        (["sensor=radar"], "choose one of mono"),
        (["exposure=-1"], "exposure_ms"),
    ],
)
def test_what_cannot_be_is_refused_by_name(words, message):
    with pytest.raises(SpecError, match=message):
        put(*words)


def test_vibrations_out_of_range_are_refused():
    with pytest.raises(SpecError, match="vibration=93 is ill-formed"):
        vibrations_of(["vibration=93"])
    with pytest.raises(SpecError, match="frequency"):
        vibrations_of(["vibration=0:0.1"])
    assert all(word.form and word.note for word in WORDS.values())
