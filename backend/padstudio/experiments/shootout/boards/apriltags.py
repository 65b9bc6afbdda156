"""AprilTags by pupil-apriltags: single tags of three families, and nested ones of a fourth.

The package's detector frees memory twice when it is thrown away, so it is used in processes that
end without doing so (`padstudio.experiments.shootout.child`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image
from padstudio.experiments.shootout.boards.aruco import Read
from padstudio.experiments.shootout.boards.board_pose import pose_of_squares
from padstudio.experiments.shootout.boards.sheets import LEAST_MODULE_MM, Page, centred
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import Layout

#: The family whose tags leave two by two modules free in their middle.
NESTED = "tagCustom48h12"
_FREE_MODULES = 2
# Corners of a detection, in its order: bottom left first, counter-clockwise on the page.
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) / 2
# Pixels are whole where the library's coordinates are halves.
_PIXEL_OFFSET = 0.5
# The library's own default, of which the package makes a whole number.
_SHARPENING = 0.25
# Wrong bits that are put right. The package's own two would take 2.4 GB of memory for the largest
# family, and make tags of nothing in the smallest.
_MOST_WRONG_BITS = 1
_ANY_FAMILY = "tag16h5"


@cache
def _detector(family: str) -> Any:
    """A detector of one family, which lives as long as its process."""
    import pupil_apriltags

    detector = pupil_apriltags.Detector(families=_ANY_FAMILY, nthreads=1)
    pointer, library, known = detector.tag_detector_ptr, detector.libc, detector.tag_families
    library.apriltag_detector_remove_family(pointer, known[_ANY_FAMILY])
    create = getattr(library, f"{family}_create")
    create.restype = type(known[_ANY_FAMILY])
    known[family] = create()
    library.apriltag_detector_add_family_bits(pointer, known[family], _MOST_WRONG_BITS)
    pointer.contents.decode_sharpening = _SHARPENING
    return detector


def _family(family: str) -> Any:
    return _detector(family).tag_families[family].contents


def _modules(family: str, number: int) -> NDArray[np.uint8]:
    """(N, N) uint8: a tag as its code says, painted white and black as the library reads it."""
    words = _family(family)
    total, border = words.total_width, words.width_at_border
    grey = np.zeros((total, total), np.uint8)
    # Beyond the border of most families there is white, within that of the others.
    white = border if words.reversed_border else border + 2
    start = (total - white) // 2
    grey[start : start + white, start : start + white] = 255
    grey[start + 1 : start + white - 1, start + 1 : start + white - 1] = 0
    offset, code = (total - border) // 2, words.codes[number]
    for bit in range(words.nbits):
        # Those of bits beyond the border are negative.
        x, y = (int(np.uint32(place[bit]).view(np.int32)) for place in (words.bit_x, words.bit_y))
        grey[y + offset, x + offset] = 255 * (code >> (words.nbits - 1 - bit) & 1)
    return grey


def tag_sheet(family: str) -> Callable[[Page], Layout]:
    """A maker of a sheet with one tag over the whole page."""
    return lambda page: centred(_modules(family, 0), page.side_mm, page)


def tag_reader(family: str) -> Callable[[Page, Camera, bool], Read]:
    """A maker of readers of `tag_sheet`."""

    def make(page: Page, camera: Camera, thorough: bool) -> Read:
        return _reader(family, [page.side_mm], camera, thorough)

    return make


def _nested_mm(page: Page, total: int) -> list[float]:
    """Sides of the nested tags with all their modules, the outermost first."""
    sides = [page.side_mm]
    while (inner := sides[-1] * _FREE_MODULES / total) / total >= LEAST_MODULE_MM:
        sides.append(inner)
    return sides


def nested_sheet(page: Page) -> Layout:
    """Tags in each other's free middle, as long as modules are at least `LEAST_MODULE_MM`."""
    total = _family(NESTED).total_width
    grey = np.zeros((_FREE_MODULES, _FREE_MODULES), np.uint8)
    for number in reversed(range(len(_nested_mm(page, total)))):
        scale = len(grey) // _FREE_MODULES
        out = np.kron(_modules(NESTED, number), np.ones((scale, scale), np.uint8))
        start = (len(out) - len(grey)) // 2
        out[start : start + len(grey), start : start + len(grey)] = grey
        grey = out.astype(np.uint8)
    return centred(grey, page.side_mm, page)


def nested_reader(page: Page, camera: Camera, thorough: bool) -> Read:
    """Reads `nested_sheet`."""
    return _reader(NESTED, _nested_mm(page, _family(NESTED).total_width), camera, thorough)


def _reader(family: str, sides_mm: list[float], camera: Camera, thorough: bool) -> Read:
    """A reader of concentric tags whose numbers count from 0.

    Fast: squares are looked for at half the resolution, as is usual; thorough: at the whole one.
    """
    detector, words = _detector(family), _family(family)
    share, decimate = words.width_at_border / words.total_width, 1.0 if thorough else 2.0

    def read(bgr: Image) -> Pose | None:
        detector.tag_detector_ptr.contents.quad_decimate = decimate
        found = [
            (_CORNERS * sides_mm[tag.tag_id] * share, tag.corners - _PIXEL_OFFSET)
            for tag in detector.detect(cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY))
            if tag.tag_id < len(sides_mm)
        ]
        return pose_of_squares(found, camera, largest=True)

    return read
