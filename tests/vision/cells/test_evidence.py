"""The rule of evidence: a bound that holds, whatever the picture."""

import math

import cv2
import numpy as np
import pytest
from dense_frames import cell_grid, random_pad
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.cells.evidence import LEAST_KAPPA, Evidence, judge

COUNTS = st.integers(1, 400)
# Patches as a picture may show them, in cells.
SHAPES = ((5, 6), (9, 12), (18, 14), (30, 25))


def exact_log10(read, agree, chance, places):
    """log10 of places · P(Binomial(read, chance) ≥ agree), at most 0."""
    tail = sum(
        math.exp(
            math.lgamma(read + 1)
            - math.lgamma(k + 1)
            - math.lgamma(read - k + 1)
            + k * math.log(chance)
            + (read - k) * math.log1p(-chance)
        )
        for k in range(agree, read + 1)
    )
    return min(0.0, math.log10(places * max(tail, 1e-300)))


def agreeing(read, agree, levels=2):
    """Levels of which so many agree, the expected ones as even as they can be."""
    expected = (np.arange(read) % levels).astype(np.int8)
    levels_read = expected.copy()
    levels_read[agree:] = (levels_read[agree:] + 1) % levels
    return levels_read[None], expected[None]


@given(read=COUNTS, share=st.floats(0, 1), levels=st.integers(2, 5), places=st.integers(1, 10**6))
def test_the_bound_is_never_below_the_exact_tail(read, share, levels, places):
    agree = round(share * read)
    found, expected = agreeing(read, agree, levels)
    evidence = judge(found, expected, levels, places)
    frequency = np.bincount(expected[0], minlength=levels) / read
    chance = min(max(float((frequency**2).sum()), 1 / levels), 0.95)
    assert evidence.log10_false_alarm >= exact_log10(read, agree, chance, places) - 1e-6
    assert evidence.log10_false_alarm <= 0


@given(read=COUNTS, levels=st.integers(2, 4), places=st.integers(1, 10**6))
def test_more_agreement_is_never_weaker_evidence(read, levels, places):
    steps = sorted({0, read // 3, read // 2, (2 * read) // 3, read - 1, read})
    evidence = [judge(*agreeing(read, agree, levels), levels, places) for agree in steps]
    values = [item.log10_false_alarm for item in evidence]
    assert values == sorted(values, reverse=True)
    assert [item.kappa for item in evidence] == sorted(item.kappa for item in evidence)
    assert [item.wrong for item in evidence] == [read - agree for agree in steps]


@given(read=st.integers(20, 200), places=st.integers(1, 10**5))
def test_more_places_to_choose_from_weaken_it(read, places):
    near, far = (judge(*agreeing(read, read), 2, count) for count in (places, 10 * places))
    assert far.log10_false_alarm >= near.log10_false_alarm


@given(seed=st.integers(0, 10**6), turn=st.integers(0, 3))
def test_only_which_cells_agree_counts(seed, turn):
    rng = np.random.default_rng(seed)
    found = rng.integers(-1, 3, (9, 14)).astype(np.int8)
    expected = rng.integers(-1, 3, (9, 14)).astype(np.int8)
    here = judge(found, expected, 3, 1000)
    assert judge(np.rot90(found, turn), np.rot90(expected, turn), 3, 1000) == here
    order = rng.permutation(found.size)
    shuffled = (a.ravel()[order].reshape(a.shape) for a in (found, expected))
    assert judge(*shuffled, 3, 1000) == here


def test_cells_not_read_or_off_the_pad_do_not_count():
    found, expected = agreeing(60, 58)
    more = np.full((1, 40), -1, np.int8)
    anything = np.ones((1, 40), np.int8)
    wide = judge(np.hstack([found, more, anything]), np.hstack([expected, anything, more]), 2, 99)
    assert wide == judge(found, expected, 2, 99)


def test_nothing_read_proves_nothing():
    nothing = np.full((4, 4), -1, np.int8)
    assert judge(nothing, nothing, 2, 10) == Evidence(0, 0, 0.0, 0.0)


def test_a_field_of_one_level_proves_nothing_much():
    """Where nearly all cells are expected dark, a dark picture agrees by chance."""
    found, expected = np.zeros((1, 100), np.int8), np.zeros((1, 100), np.int8)
    assert not judge(found, expected, 2, 60_000).suffices(-7)


def test_many_cells_that_agree_a_little_do_not_suffice():
    found, expected = agreeing(100_000, 60_000)
    evidence = judge(found, expected, 2, 60_000)
    assert evidence.log10_false_alarm < -100
    assert evidence.kappa < LEAST_KAPPA
    assert not evidence.suffices(-7)


@pytest.mark.parametrize("levels", [2, 3])
def test_random_patches_never_suffice_at_their_best_place(levels):
    pad = random_pad(3, levels=levels, cells=(50, 25))
    indices = [LayerIndex(pad, layer) for layer in pad.layers]
    rng = np.random.default_rng(17)
    least = 0.0
    for number in range(1000):
        patch = rng.integers(0, levels, SHAPES[number * len(SHAPES) // 1000])
        for index in indices:
            placement = index.locate(cell_grid(patch))
            assert placement is not None
            least = min(least, placement.evidence.log10_false_alarm)
            assert not placement.evidence.suffices(-7)
    # Of thousands of draws the best may look like one in thousands, not much better.
    assert least > -5


def test_smooth_random_patches_never_suffice():
    """Neighbouring cells of a real ground are alike, which the binomial law does not know."""
    pad = random_pad(4, cells=(50, 25))
    indices = [LayerIndex(pad, layer) for layer in pad.layers]
    rng = np.random.default_rng(18)
    for number in range(1000):
        noise = rng.standard_normal(SHAPES[number * len(SHAPES) // 1000])
        smooth = cv2.GaussianBlur(noise, (0, 0), rng.uniform(0.5, 3))
        patch = smooth > np.median(smooth)
        for index in indices:
            placement = index.locate(cell_grid(patch))
            assert placement is None or not placement.evidence.suffices(-7)


@pytest.mark.parametrize(
    ("log10", "kappa", "says"),
    [
        (0.0, 0.1, "any picture may match so well; a chance of 10^-9 is needed"),
        (-0.04, 0.1, "any picture may match so well; a chance of 10^-9 is needed"),
        (-3.21, 0.5, "chance of such a match 10^-3.2, 10^-9 is needed"),
        (-20.0, 0.05, f"they agree by 0.05 beyond chance, {LEAST_KAPPA:g} is needed"),
    ],
)
def test_what_evidence_lacks_is_said_in_words_that_mean_something(log10, kappa, says):
    assert Evidence(50, 20, log10, kappa).compared_with(-9.0) == says
