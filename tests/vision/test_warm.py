"""Warming compiles every inner loop that a detection may need."""

from padstudio.compiled import Compiled
from padstudio.geometry import planar_pnp_kernel, projection
from padstudio.vision import warm
from padstudio.vision.cells import cells_kernel
from padstudio.vision.frame import pixels_kernel
from padstudio.vision.pose import (
    drift_kernel,
    edge_points_kernel,
    least_squares_kernel,
    measured_kernel,
    noise_kernel,
)
from padstudio.vision.pose.pattern import (
    rows_kernel,
    solver_kernel,
    template_kernel,
)
from padstudio.vision.search import search_kernel


def test_warming_reads_its_frames_and_compiles_every_kernel():
    assert warm.warm_up()
    for module in (
        projection,
        edge_points_kernel,
        cells_kernel,
        least_squares_kernel,
        drift_kernel,
        measured_kernel,
        noise_kernel,
        rows_kernel,
        solver_kernel,
        template_kernel,
        pixels_kernel,
        planar_pnp_kernel,
        search_kernel,
    ):
        compiled = [f for f in vars(module).values() if isinstance(f, Compiled)]
        # Loops that only other loops call have no signature of their own until Python calls them.
        assert any(loop.dispatcher.signatures for loop in compiled), module.__name__
    for called in (
        projection.project,
        edge_points_kernel.borders_in_view,
        edge_points_kernel.find_borders,
        cells_kernel.sample,
        cells_kernel.locate,
        planar_pnp_kernel.fit_mirrored,
        pixels_kernel.impulses,
        least_squares_kernel.fit,
        planar_pnp_kernel.fit_points,
        least_squares_kernel.scatter,
        drift_kernel.drifting,
        measured_kernel.measured,
        measured_kernel.weighed,
        measured_kernel.blur_variance,
        rows_kernel.match_rows,
        rows_kernel.blur_variance,
        solver_kernel.brightness_at,
        solver_kernel.settle,
        template_kernel.blurred_cells,
        template_kernel.pixels_on_pad,
        pixels_kernel.values_at,
        search_kernel.climb,
    ):
        assert called.dispatcher.signatures, called.__name__
