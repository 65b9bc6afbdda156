"""Puts a budget together: amounts of all sources, their sum, and what each change would do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.experiments.budget.amounts import (
    MEASURES,
    Amount,
    Excess,
    Sample,
    alone,
    beside,
    over,
)
from padstudio.experiments.budget.changes import CHANGES, Change
from padstudio.experiments.budget.conditions import SOURCES, SourceName
from padstudio.experiments.budget.frames import Reading
from padstudio.experiments.budget.order import (
    BudgetOrder,
    Case,
    floor_case,
    source_case,
    whole_case,
)

#: Reads all frames in each case, and gives for each case what was said of each frame.
Measure = Callable[[Sequence[Case]], list[list[Reading]]]
# Sources that are beliefs of the detector: pictures and noise are those of the floor.
_BELIEFS = ("print_scale", "calibration")
_POSITION = MEASURES.index("position")


@dataclass(frozen=True)
class Contribution:
    """What one source adds, or several together.

    Attributes
    ----------
    amounts : tuple of Amount, or None
        Of `MEASURES`; None where too few frames were read.
    full, bearing, none : int
        Frames that were read; of which range and bearing alone can be used; that were not read.
    mbit_s : float or None
        What the stream took, on the mean.
    """

    amounts: tuple[Amount, ...] | None
    full: int
    bearing: int
    none: int
    mbit_s: float | None = None


@dataclass(frozen=True)
class Effect:
    """What a change would do to the sum in quadrature of the position's error.

    Attributes
    ----------
    change : Change
    after_mm : Amount or None
        The sum after it; None where too few frames were read.
    gain_mm, gain_low_mm, gain_high_mm : float
        By how much the sum falls, with bounds of confidence, 95 %.
    read : int
        Frames that were read with the changed source.
    """

    change: Change
    after_mm: Amount | None
    gain_mm: float
    gain_low_mm: float
    gain_high_mm: float
    read: int

    @property
    def helps(self) -> bool:
        """Whether the gain can be told from chance."""
        return self.after_mm is not None and self.gain_low_mm > 0


@dataclass(frozen=True)
class Budget:
    """An error budget.

    Attributes
    ----------
    order : BudgetOrder
    sources : mapping of SourceName to Contribution
    kinds : mapping
        ``"random"`` and ``"systematic"`` sources together, in quadrature, as far as measured.
    total : tuple of Amount or None
        All sources' sum in quadrature; None where one is not measured.
    whole : Contribution
        All sources on in one run.
    ratio : (low, value, high) or None
        Of the mean squares of the position's error, ``whole`` over ``total``.
    effects : list of Effect
        The largest gain first.
    best : Effect or None
        The change that would help most, of those that help by more than chance.
    after : Contribution or None
        All sources on in one run after that change, where the order asks for it.
    """

    order: BudgetOrder
    sources: Mapping[SourceName, Contribution]
    kinds: Mapping[str, tuple[Amount, ...]]
    total: tuple[Amount, ...] | None
    whole: Contribution
    ratio: tuple[float, float, float] | None
    effects: list[Effect]
    best: Effect | None
    after: Contribution | None


def first_cases(order: BudgetOrder) -> list[Case]:
    """All cases but the last, which follows from their result."""
    sizes = order.conditions
    cases = [source_case(sizes, source) for source in SOURCES]
    cases.append(whole_case(sizes))
    for change in _changes(order):
        cases += change.cases(sizes).values()
    return cases


def make_budget(order: BudgetOrder, measure: Measure) -> Budget:
    """Measure all cases, and say what follows.

    Parameters
    ----------
    order : BudgetOrder
    measure : callable
        Called with `first_cases`, and with the one that checks the best change.
    """
    sizes = order.conditions
    cases = first_cases(order)
    told = dict(zip(cases, measure(cases), strict=True))
    sample = Sample(order.frames, order.seed)
    floor = told[floor_case(sizes)]
    excesses = {
        source: _excess(source, told[source_case(sizes, source)], floor) for source in SOURCES
    }
    squares = {source: sample.means(x) for source, x in excesses.items() if x.is_measured}
    total = sum(squares.values()) if len(squares) == len(SOURCES) else None
    whole = told[whole_case(sizes)]
    effects = [_effect(each, order, told, squares, sample) for each in _changes(order)]
    effects.sort(key=lambda each: _rank(each, squares), reverse=True)
    best = next((each for each in effects if _is_best(each, squares)), None)
    after = None
    if best is not None and order.is_checked:
        [readings] = measure([best.change.whole(sizes)])
        after = _contribution(readings, alone(readings), sample)
    return Budget(
        order=order,
        sources={
            source: _contribution(told[source_case(sizes, source)], excesses[source], sample)
            for source in SOURCES
        },
        kinds=_kinds(squares, sample),
        total=None if total is None else sample.amounts(np.asarray(total)),
        whole=_contribution(whole, alone(whole), sample),
        ratio=_ratio(whole, total, sample),
        effects=effects,
        best=best,
        after=after,
    )


def _changes(order: BudgetOrder) -> list[Change]:
    return [change for change in CHANGES.values() if change.is_possible(order)]


def _excess(source: str, readings: list[Reading], floor: list[Reading]) -> Excess:
    if source == "pixels":
        return alone(readings)
    return (beside if source in _BELIEFS else over)(readings, floor)


def _contribution(readings: list[Reading], excess: Excess, sample: Sample) -> Contribution:
    states = [each.state for each in readings]
    rates = [each.mbit_s for each in readings if each.mbit_s is not None]
    return Contribution(
        sample.amounts(sample.means(excess)) if excess.is_measured else None,
        states.count("full"),
        states.count("bearing"),
        states.count("none"),
        sum(rates) / len(rates) if rates else None,
    )


def _kinds(squares: Mapping[SourceName, Array], sample: Sample) -> dict[str, tuple[Amount, ...]]:
    out = {}
    for kind in ("random", "systematic"):
        mine = [x for source, x in squares.items() if SOURCES[source].kind == kind]
        if mine:
            out[kind] = sample.amounts(np.asarray(sum(mine)))
    return out


def _ratio(
    whole: list[Reading], total: Array | int | None, sample: Sample
) -> tuple[float, float, float] | None:
    together = alone(whole)
    if total is None or not together.is_measured:
        return None
    parts = np.asarray(total)[:, _POSITION]
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = sample.means(together)[:, _POSITION] / np.maximum(parts, 1e-12)
    low, high = sample.bounds(ratios)
    return low, float(ratios[0]), high


def _effect(
    change: Change,
    order: BudgetOrder,
    told: Mapping[Case, list[Reading]],
    squares: Mapping[SourceName, Array],
    sample: Sample,
) -> Effect:
    cases = change.cases(order.conditions)
    floor = told[cases.get("pixels", floor_case(order.conditions))]
    read = sum(each.state == "full" for each in told[cases[change.source]])
    after = dict(squares)
    for source, case in cases.items():
        excess = _excess(source, told[case], floor)
        if not excess.is_measured:
            return Effect(change, None, 0.0, 0.0, 0.0, read)
        after[source] = sample.means(excess)
    before_sum = sum((x[:, _POSITION] for x in squares.values()), np.zeros(1))
    after_sum = sum((x[:, _POSITION] for x in after.values()), np.zeros(1))
    gains = np.sqrt(np.maximum(before_sum, 0)) - np.sqrt(np.maximum(after_sum, 0))
    gains = np.broadcast_to(gains, np.shape(after_sum))
    low, high = sample.bounds(gains)
    return Effect(change, sample.amount(after_sum), float(gains[0]), low, high, read)


def _rank(effect: Effect, squares: Mapping[SourceName, Array]) -> tuple[int, float]:
    """A change by which frames come to be read goes before all whose gain is measured."""
    won = effect.read if effect.change.source not in squares else 0
    return won, effect.gain_mm


def _is_best(effect: Effect, squares: Mapping[SourceName, Array]) -> bool:
    return effect.helps or (effect.change.source not in squares and effect.read > 0)
