"""What a budget says, in words with figures."""

from __future__ import annotations

from padstudio.experiments.budget.amounts import MEASURES, Amount
from padstudio.experiments.budget.budget import Budget
from padstudio.experiments.budget.conditions import SOURCES
from padstudio.experiments.report import Claim

_POSITION = MEASURES.index("position")
# An interval of the ratio of mean squares that is as wide as this says nothing of a sum.
_TELLING = 4.0


def words_of(budget: Budget) -> tuple[str, ...]:
    """The paragraphs that open a report: how far off, what most comes from, what to change."""
    return (_whole(budget), _largest(budget), change_words(budget), *_unread(budget))


def mm(amount: Amount) -> str:
    """An amount with its bounds."""
    return f"{amount.value:.3g} mm ({amount.low:.3g} … {amount.high:.3g})"


def _whole(budget: Budget) -> str:
    whole, order = budget.whole, budget.order
    read = f"{whole.full} of {order.frames} frames were read as a full pose"
    if whole.amounts is None:
        return f"With all sources on, {read}: too few for an error to be told."
    position = whole.amounts[_POSITION]
    share = 100 * position.value / order.height_mm
    attitude = whole.amounts[MEASURES.index("attitude")].value
    return (
        f"With all sources on, the position is off by {mm(position)}, root mean square: "
        f"{share:.2g} % of the height; the attitude by {attitude:.2g}°; {read}."
    )


def _largest(budget: Budget) -> str:
    amounts = {
        source: each.amounts[_POSITION] for source, each in budget.sources.items() if each.amounts
    }
    told = {source: each for source, each in amounts.items() if each.is_resolved}
    if not told:
        return "No source by itself can be told from nothing."
    source = max(told, key=lambda name: told[name].value)
    lost = [SOURCES[each].title for each in amounts if each not in told]
    noise = f" Not to be told from nothing: {', '.join(lost).lower()}." if lost else ""
    kinds = [
        f"{kind} sources together make {mm(found[_POSITION])}"
        for kind, found in budget.kinds.items()
    ]
    return (
        f"The largest is {SOURCES[source].title.lower()} ({SOURCES[source].kind}): "
        f"{mm(told[source])}. In quadrature {'; '.join(kinds)}; the mean of many frames keeps the "
        f"systematic part.{noise}"
    )


def change_words(budget: Budget) -> str:
    """The one change that would help most."""
    best = budget.best
    if best is None:
        return "None of the changes that were tried helps by more than chance."
    title = f"The one change that would help most: {best.change.title}."
    if best.after_mm is None or best.change.source not in _measured(budget):
        return (
            f"{title} With it {best.read} of {budget.order.frames} frames are read under "
            f"{SOURCES[best.change.source].title.lower()}, which now are not."
        )
    before = best.after_mm.value + best.gain_mm
    words = (
        f"{title} The sum in quadrature would fall from {before:.3g} to {best.after_mm.value:.3g} "
        f"mm, by {best.gain_mm:.3g} mm ({best.gain_low_mm:.3g} … {best.gain_high_mm:.3g})."
    )
    if budget.after is not None and budget.after.amounts is not None:
        words += f" Simulated with all sources on it is {mm(budget.after.amounts[_POSITION])}."
    return words


def additivity(budget: Budget) -> Claim:
    """Whether the sources add in quadrature, by one run with all of them on."""
    text = "The sources add in quadrature."
    if budget.ratio is None or budget.total is None or budget.whole.amounts is None:
        return Claim(text, "not measured", "A source, or all together, was read in too few frames.")
    low, value, high = (max(each, 0.0) ** 0.5 for each in budget.ratio)
    together, parts = budget.whole.amounts[_POSITION], budget.total[_POSITION]
    because = (
        f"All together {mm(together)}, the sum in quadrature {mm(parts)}: a ratio of {value:.2f} "
        f"({low:.2f} … {high:.2f})."
    )
    if not low <= 1 <= high:
        return Claim(text, "does not hold", f"{because} Sources act on each other.")
    if high > _TELLING**0.5 * max(low, 1e-9):
        return Claim(
            text, "not measured", f"{because} The bounds are too wide to tell; take more frames."
        )
    return Claim(text, "held", because)


def _measured(budget: Budget) -> set[str]:
    return {source for source, each in budget.sources.items() if each.amounts is not None}


def _unread(budget: Budget) -> list[str]:
    parts = []
    for source, each in budget.sources.items():
        if each.full < budget.order.frames:
            parts.append(
                f"{SOURCES[source].title.lower()}: {each.none} not read, {each.bearing} with range "
                "and bearing alone"
            )
    if not parts:
        return []
    frames = budget.order.frames
    return [
        f"Of {frames} frames each, these have no full pose and are left out of the errors – "
        + "; ".join(parts)
        + "."
    ]
