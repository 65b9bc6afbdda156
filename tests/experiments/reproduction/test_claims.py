"""Verdicts follow from the figures, whichever way these go."""

from __future__ import annotations

import pytest
import synthetic_frames
from synthetic_frames import Reads, frames_of

from padstudio.experiments.report import Claim, Section
from padstudio.experiments.reproduction.plan import EXPERIMENTS, ExperimentName, Shot
from padstudio.experiments.reproduction.range_claims import range_claims
from padstudio.experiments.reproduction.sections import section_of
from padstudio.experiments.reproduction.series_claims import beyond_claim, steps_claim
from padstudio.experiments.reproduction.spans import cells_across, least_height_cm


def always(kind: str, shot: Shot) -> bool:
    return True


def never(kind: str, shot: Shot) -> bool:
    return False


def geometry(kind: str, shot: Shot) -> bool:
    """The coarse layer where a window fits, the fine one below half a metre."""
    height = shot.where.height_mm
    if kind.endswith("coarse"):
        return height >= 10 * least_height_cm(50)
    return height < 500 if kind.endswith("fine") else True


def section(name: ExperimentName, reads: Reads, **options: float) -> Section:
    return section_of(name, frames_of(reads, [name], **options))  # type: ignore[arg-type]


def test_a_coarse_window_does_not_fit_from_18_cm() -> None:
    assert cells_across(180, 50) == pytest.approx(2.92, abs=0.01)
    assert least_height_cm(50) == pytest.approx(30.8, abs=0.05)
    whole, coarse, fine, between = range_claims(frames_of(geometry, ["ranges"]))
    assert whole.verdict == "held"
    assert "154.1 cm" in whole.because
    assert coarse.sentence == "Held within 31 to 154 cm."
    assert "sees 2.9 cells of 50 mm" in coarse.because
    assert "cannot hold by its own geometry" in coarse.because
    assert fine.verdict == between.verdict == "held"


def test_a_layer_that_reads_nowhere_does_not_hold_its_claim() -> None:
    _, coarse, fine, between = range_claims(frames_of(never, ["ranges"]))
    assert {coarse.verdict, fine.verdict, between.verdict} == {"does not hold"}
    assert "reads at none of 8 places" in coarse.because


def test_a_claim_that_all_places_bear_out_says_nothing_of_geometry() -> None:
    _, coarse, _, _ = range_claims(frames_of(always, ["ranges"]))
    assert coarse.verdict == "held"
    assert "geometry" not in coarse.because


@pytest.mark.parametrize(
    ("reads", "error_mm", "verdict"),
    [(always, 0.1, "held"), (always, 20.0, "does not hold"), (never, 0.1, "does not hold")],
)
def test_a_series_is_held_where_it_is_read_and_well(
    reads: Reads, error_mm: float, verdict: str
) -> None:
    claim = section("horizontal", reads, error_mm=error_mm).claims[0]
    assert claim.verdict == verdict
    assert ("of 7 places, with errors" in claim.because) == (reads is always)


def test_the_verdict_is_the_papers_methods_not_the_other_ones() -> None:
    dense = section("horizontal", lambda kind, shot: kind == "dense").claims[0]
    paper = section("horizontal", lambda kind, shot: kind == "paper").claims[0]
    assert (dense.verdict, paper.verdict) == ("does not hold", "held")


def test_nine_of_ten_frames_make_a_place() -> None:
    def misses_at_zero(kind: str, shot: Shot) -> bool:
        return not (shot.where.x_mm == 0 and shot.seed < missed)

    missed = 1
    assert section("horizontal", misses_at_zero, seeds=10).claims[0].verdict == "held"
    missed = 2
    claim = section("horizontal", misses_at_zero, seeds=10).claims[0]
    assert claim.sentence == "Held within -300 to -100 mm."


def test_failing_beyond_40_degrees_is_the_claim() -> None:
    def fails_beyond(kind: str, shot: Shot) -> bool:
        return shot.where.tilt_deg <= 40 or shot.seed % 2 == 0

    def claim(reads: Reads) -> Claim:
        return beyond_claim(frames_of(reads, ["attitude"]))

    assert claim(fails_beyond).verdict == "held"
    assert "50 % at 75°" in claim(fails_beyond).because
    assert claim(always).verdict == "does not hold"


def test_a_step_that_jumps_by_a_cell_breaks_continuity() -> None:
    frames = frames_of(always, ["continuity"])
    assert steps_claim(frames).verdict == "held"
    jumped = synthetic_frames.synthetic(frames[-1].shot, always, error_mm=10.1)
    claim = steps_claim([*frames[:-1], jumped])
    assert claim.verdict == "held within"
    assert "10 mm at most" in claim.because


@pytest.mark.parametrize("reads", [always, never])
@pytest.mark.parametrize("name", [name for name in EXPERIMENTS if name != "stages"])
def test_every_section_is_whole_whatever_was_read(name: ExperimentName, reads: Reads) -> None:
    found = section(name, reads, seeds=2)
    assert found.claims
    assert found.figures
    for table in found.tables:
        assert all(len(row) == len(table.columns) for row in table.shown)
    for figure in found.figures:
        assert b"nan" not in figure.data
