"""When a match counts: the rule by which a pose is given or refused.

Of N cells read blind, k agree with the pad at the best of M places, turns and lattices looked at.
In a picture without this pad a cell agrees with one place by chance with probability q = Σ p²
over the frequencies of the levels there, so k or more agree at any of the M places with a
probability of at most M · P(Binomial(N, q) ≥ k). A match counts where that bound is below
`DetectorParams.log10_false_alarm`, and the share of agreeing cells stands clear of q whatever
N is: neighbouring "cells" of a picture that is no pad are not independent, so that a large N
alone must not win.

The bound is that of an a-contrario test (the number of false alarms); the share of the way from
chance to perfect agreement is Cohen's kappa, with q for the agreement by chance.

References
----------
Desolneux, A., Moisan, L. and Morel, J.-M. (2000). Meaningful alignments.
doi:10.1023/A:1026593302236. Cohen, J. (1960). A coefficient of agreement for nominal scales.
doi:10.1177/001316446002000104.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.vision.cells import cells_kernel

#: Least kappa, (k/N − q) / (1 − q): about half way.
LEAST_KAPPA = 0.45


@dataclass(frozen=True)
class Evidence:
    """How well read cells agree with a place on the pad.

    Attributes
    ----------
    read, wrong : int
        Cells compared, and those that differ.
    log10_false_alarm : float
        Base-10 logarithm of the bound on the chance that a picture without this pad agrees as
        well at any place.
    kappa : float
        Chance-corrected agreement: 0 by chance, 1 perfect.
    """

    read: int
    wrong: int
    log10_false_alarm: float
    kappa: float

    def suffices(self, log10_false_alarm: float, *, least_kappa: float = LEAST_KAPPA) -> bool:
        """True where a pose may rest on it."""
        return self.kappa >= least_kappa and self.log10_false_alarm <= log10_false_alarm

    def compared_with(self, log10_false_alarm: float) -> str:
        """What was reached and what is needed, for a sentence."""
        needed = f"10^{log10_false_alarm:.0f} is needed"
        if self.log10_false_alarm > -0.5:
            return f"any picture may match so well; a chance of {needed}"
        if self.log10_false_alarm > log10_false_alarm:
            return f"chance of such a match 10^{self.log10_false_alarm:.1f}, {needed}"
        return f"they agree by {self.kappa:.2f} beyond chance, {LEAST_KAPPA:g} is needed"


def judge(
    levels: NDArray[np.int8], expected: NDArray[np.int8], count: int, places: int
) -> Evidence:
    """Compare levels read blind with those of one place of the pad.

    Parameters
    ----------
    levels, expected : (R, C) int8
        −1 where a cell was not read, or lies off the pad.
    count : int
        Y, the pad's number of levels.
    places : int
        Places and turns among which this one is the best.
    """
    agree, frequency = cells_kernel.compare(levels, expected, count)
    read = int(frequency.sum())
    chance = _chance(frequency, count)
    return Evidence(
        read=read,
        wrong=read - agree,
        log10_false_alarm=_log10_bound(read, agree, chance, places),
        kappa=(agree / read - chance) / (1 - chance) if read else 0.0,
    )


def _chance(frequency: NDArray[np.intp], count: int) -> float:
    """Agreement of independent levels as frequent as those expected, at least 1/Y."""
    read = max(int(frequency.sum()), 1)
    return float(min(max(((frequency / read) ** 2).sum(), 1 / count), 0.95))


def _log10_bound(read: int, agree: int, chance: float, places: int) -> float:
    """log10 of places · P(Binomial(read, chance) ≥ agree), from above, at most 0.

    Beyond the mean each term of the tail is below the one before by a ratio that falls, so the
    geometric series of the first ratio bounds the sum.
    """
    if not read or agree <= chance * read:
        return 0.0
    first = (
        math.lgamma(read + 1)
        - math.lgamma(agree + 1)
        - math.lgamma(read - agree + 1)
        + agree * math.log(chance)
        + (read - agree) * math.log(1 - chance)
    )
    ratio = (read - agree) / (agree + 1) * chance / (1 - chance)
    tail = first - math.log(1 - min(ratio, 1 - 1e-9))
    return min(0.0, (tail + math.log(places)) / math.log(10))
