"""PuzzleBoards by calib-targets: chessboards whose edges carry a bit each."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from PIL import Image as Pictures

from padstudio.arrays import Image
from padstudio.experiments.shootout.boards.aruco import Read
from padstudio.experiments.shootout.boards.board_pose import pose_of
from padstudio.experiments.shootout.boards.sheets import Page, centred
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import Layout

# The printer takes dots per inch: with squares of an inch they are pixels a square.
_INCH_MM = 25.4
# So many pixels in all along the longer side, so that dots of large squares are round.
_PIXELS = 1500


def puzzle_sheet(along: int) -> Callable[[Page], Layout]:
    """A maker of a sheet with so many squares along the longer side, as its printer paints it."""

    def make(page: Page) -> Layout:
        import calib_targets

        columns, rows, side_mm = page.places(along)
        pixels = max(_PIXELS // along, 12)
        size = calib_targets.PageSize.custom(width_mm=_INCH_MM * columns, height_mm=_INCH_MM * rows)
        document = calib_targets.puzzleboard_document(
            rows,
            columns,
            _INCH_MM,
            page=calib_targets.PageSpec(size=size, margin_mm=0.0),
            render=calib_targets.RenderOptions(png_dpi=pixels),
        )
        png = calib_targets.render_target_bundle(document).png_bytes
        grey = np.asarray(Pictures.open(io.BytesIO(png)).convert("L"))
        if grey.shape != (rows * pixels, columns * pixels):
            raise RuntimeError(f"calib-targets painted {grey.shape}, not {pixels} a square")
        return centred(np.where(grey < 128, 0, 255).astype(np.uint8), columns * side_mm, page)

    return make


def puzzle_reader(along: int) -> Callable[[Page, Camera, bool], Read]:
    """A maker of readers of `puzzle_sheet`.

    Fast: the board is looked for where its place is known (``fixed_board``). Thorough: with each of
    the settings that calib-targets itself tries in turn, the best of all.
    """

    def make(page: Page, camera: Camera, thorough: bool) -> Read:
        columns, rows, side_mm = page.places(along)
        find = _finder(rows, columns, thorough)

        def read(bgr: Image) -> Pose | None:
            try:
                found = find(np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY), np.uint8))
            except RuntimeError:
                # How it says that nothing was found.
                return None
            pixels = np.array([corner.position for corner in found.corners], float)
            places = np.array([corner.target_position for corner in found.corners], float)
            points = (places - [columns / 2, rows / 2]) * [side_mm, -side_mm]
            return pose_of(points, pixels, camera)

        return read

    return make


def _finder(rows: int, columns: int, thorough: bool) -> Callable[[Image], Any]:
    import calib_targets

    usual = calib_targets.default_puzzleboard_params(rows, columns)
    fixed = calib_targets.PuzzleBoardSearchMode.fixed_board()
    if not thorough:
        usual.decode.search_mode = fixed
        return lambda grey: calib_targets.detect_puzzleboard(grey, params=usual)
    sweep = calib_targets.PuzzleBoardParams.sweep_for_board(usual.board)
    for each in sweep:
        each.decode.search_mode = fixed
    return lambda grey: calib_targets.detect_puzzleboard_best(grey, sweep)
