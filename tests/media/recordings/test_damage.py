"""Recordings cut anywhere or with bytes changed: refused by name, or read as far as they go."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import recordings as made
import videos
from hypothesis import given, settings
from hypothesis import strategies as st
from recordings import START_NS, STEP_NS, Scene

from padstudio.errors import StudioError
from padstudio.media.recordings.frames import read_frames
from padstudio.media.recordings.index import read_index
from padstudio.media.recordings.topics import look

KINDS = ("a.bag", "a.mcap", "loose.mcap", "video.mcap", "a.db3")
FRAMES = 12


class Whole(dict[str, bytes]):
    """Recordings by name, of which hypothesis shows no bytes."""

    def __repr__(self) -> str:
        return f"Whole({list(self)})"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """A recording of each kind."""
    folder, png = tmp_path_factory.mktemp("whole"), Scene(kind="compressed")
    paths = [
        made.write_bag1(folder / "a.bag", png),
        made.write_mcap(folder / "a.mcap", png, chunk_size=4000),
        made.write_mcap(folder / "loose.mcap", png, use_chunking=False),
        made.write_mcap(folder / "video.mcap", Scene(kind="video"), chunk_size=4000),
        next(made.write_bag2(folder / "a", png).glob("*.db3")),
    ]
    return Whole({path.name: path.read_bytes() for path in paths})


def _read(path: Path) -> Iterator[tuple[int, int | None]]:
    """What each frame's time says that it shows, and what it shows."""
    look(str(path))
    index = read_index(str(path))
    pts = index.video.pts.tolist()
    pictures = list(read_frames(str(path), pts, index.times))
    assert [picture.pts for picture in pictures] == pts
    for picture in pictures:
        shown = None if picture.bgr is None else videos.number_of(picture.bgr)
        yield round((picture.pts - START_NS) / STEP_NS), shown


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=12)
@given(share=st.floats(0.01, 0.999))
def test_what_is_left_of_a_cut_recording_is_right(
    kind: str, whole: Whole, tmp_path_factory: pytest.TempPathFactory, share: float
) -> None:
    path = tmp_path_factory.mktemp("cut") / kind
    path.write_bytes(whole[kind][: int(share * len(whole[kind]))])
    with suppress(StudioError):
        read = list(_read(path))
        assert [number for number, _ in read] == list(range(len(read)))
        assert all(number == shown for number, shown in read)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=12)
@given(seed=st.integers(0, 2**32 - 1), changes=st.sampled_from([1, 5, 50]))
def test_changed_bytes_are_no_defect(
    kind: str,
    whole: Whole,
    tmp_path_factory: pytest.TempPathFactory,
    seed: int,
    changes: int,
) -> None:
    rng, data = np.random.default_rng(seed), bytearray(whole[kind])
    for place in rng.integers(16, len(data), changes):
        data[place] ^= 1 << int(rng.integers(8))
    path = tmp_path_factory.mktemp("changed") / kind
    path.write_bytes(data)
    with suppress(StudioError):
        assert len(list(_read(path))) <= FRAMES
