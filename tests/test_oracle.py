"""The oracle of the benchmark `reality`: what it calls readable is, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from oracle import best_reading
from reality_classes import CLASSES
from reality_shots import CAMERAS, pads, plain_shot

from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.motion import Motion
from padstudio.simulate.render import render
from padstudio.simulate.vibration import Vibration


def taken(name, pad, seed=0, **changes):
    """A frame of a class, and its pad."""
    kind = CLASSES[name]
    rng = np.random.default_rng([seed, *name.encode()])
    side = min(pads()[pad].size_mm)
    shot = replace(kind.change(rng, plain_shot(rng, pads()[pad], kind, "vga"), side), **changes)
    camera = CAMERAS[kind.camera or "vga"]
    frame = render(shot.scene, camera, shot.pose, shot.imaging, seed, motion=shot.motion)
    return frame, pads()[pad]


@pytest.mark.parametrize("pad", ["paper", "other"])
@pytest.mark.parametrize("name", ["plain", "mono", "leaves-40", "waves", "gaps", "fisheye190"])
def test_it_reads_cells_where_the_truth_puts_them(name, pad):
    frame, spec = taken(name, pad)
    reading = best_reading(frame.image, spec, frame.truth)
    assert reading.readable
    # Leaves hide what they hide, and at a fisheye's rim cells are a pixel wide.
    share = reading.wrong / reading.read
    assert share < {"leaves-40": 0.35, "fisheye190": 0.25}.get(name, 0.12)


@pytest.mark.parametrize("pad", ["paper", "other"])
def test_it_reads_nothing_where_the_pad_is_not(pad):
    frame, spec = taken("plain", pad)
    other = pads()["other" if pad == "paper" else "paper"]
    bare, _ = taken("plain", pad)
    shifted = replace(
        frame.truth,
        pose=replace(
            frame.truth.pose, position_mm=frame.truth.pose.position_mm + np.array([37.0, 23.0, 0.0])
        ),
    )
    assert not best_reading(frame.image, spec, shifted).readable
    foreign = replace(bare.truth, scene=replace(bare.truth.scene, pad=other))
    assert not best_reading(bare.image, other, foreign).readable
    noise = np.random.default_rng(1).integers(0, 256, frame.image.shape, np.uint8)
    assert not best_reading(noise, spec, frame.truth).readable


def test_it_follows_the_rows_of_a_shaken_frame_and_the_sheets_of_a_tiled_print():
    shake = Vibration(frequency_hz=80.0, amplitude_deg=(0.9, 0.9, 0.0))
    frame, spec = taken("vibrating", "paper", motion=Motion(vibrations=(shake,)))
    still = replace(frame.truth, motion=Motion())
    followed = best_reading(frame.image, spec, frame.truth)
    assert followed.log10_chance < 2 * best_reading(frame.image, spec, still).log10_chance
    frame, spec = taken("swapped-sheets", "paper")
    moved = best_reading(frame.image, spec, frame.truth)
    flat = replace(frame.truth, scene=replace(frame.truth.scene, lay=Tiles(columns=6, rows=5)))
    assert moved.log10_chance < best_reading(frame.image, spec, flat).log10_chance
