"""Warming compiles every inner loop that a detection may need."""

from padstudio.vision import (
    kernels,
    kernels_borders,
    kernels_cells,
    kernels_fit,
    kernels_pattern,
    kernels_pixels,
    kernels_points,
    kernels_search,
    warm,
)


def test_warming_reads_its_frames_and_compiles_every_kernel():
    assert warm.warm_up()
    for module in (
        kernels,
        kernels_borders,
        kernels_cells,
        kernels_fit,
        kernels_pattern,
        kernels_pixels,
        kernels_points,
        kernels_search,
    ):
        compiled = [f for f in vars(module).values() if hasattr(f, "signatures")]
        # Loops that only other loops call have no signature of their own until Python calls them.
        assert any(function.signatures for function in compiled), module.__name__
    for called in (
        kernels.project,
        kernels_borders.borders_in_view,
        kernels_borders.find_borders,
        kernels_cells.sample,
        kernels_cells.width_px,
        kernels_points.fit_mirrored,
        kernels_pixels.impulses,
        kernels_fit.fit,
        kernels_points.fit_points,
        kernels_fit.normal_equations,
        kernels_pattern.match_pattern,
        kernels_pattern.blurred_cells,
        kernels_search.climb,
    ):
        assert called.signatures, called.__name__
