"""A budget as a report."""

from __future__ import annotations

from padstudio.experiments.budget.amounts import MEASURES, Amount
from padstudio.experiments.budget.bars import Bar, bars_svg
from padstudio.experiments.budget.budget import Budget, Contribution
from padstudio.experiments.budget.conditions import QUANTITIES, SOURCES
from padstudio.experiments.budget.verdict import additivity, words_of
from padstudio.experiments.report import Cell, Column, Figure, Report, Section, Table

_HOW = (
    "Each source is simulated by itself, with all others off, on the same frames: place, heading, "
    "lean, directions of motion and phases of shaking are drawn once a frame.",
    "Pixels and noise are always on: they are the floor. Of blur, rolling shutter, flatness and "
    "compression the floor's mean square error is taken off in quadrature. Print scale and "
    "calibration are wrong beliefs of the detector: it reads the floor's own pictures, and what "
    "counts is by how much each pose changes.",
    "Sizes of print scale and calibration are standard deviations; they are put on with signs of "
    "a Hadamard matrix, so that no two of them go together. Waves of the paper have a direction "
    "and a phase of their own in each frame. The true pose is relative to the plane that the "
    "paper was laid on, at the exposure of the picture's middle row.",
    "Bounds are 95 % confidence by a paired bootstrap over frames (expanded percentiles, "
    "Hesterberg 2015, doi:10.1080/00031305.2015.1089789). A source whose lower bound is 0 cannot "
    "be told from nothing. Frames are single ones, read by the dense method.",
    "Random sources differ from frame to frame; the mean of many frames, or a filter, lessens "
    "them. Systematic ones are the same throughout a landing.",
)
_LENGTH, _DEGREES = 3, 4


def report_of(budget: Budget) -> Report:
    """The report: sources as bars and a table, changes, conditions, and how it was done."""
    order = budget.order
    return Report(
        f"Error budget: {order.pad.name} at {order.height_mm:g} mm, camera {order.camera.name}",
        words_of(budget),
        (
            Section(
                "Sources",
                claims=(additivity(budget),),
                tables=(sources_table(budget),),
                figures=(_figure(budget),),
            ),
            Section("Changes", tables=(changes_table(budget),)),
            Section("Conditions", tables=(_conditions(budget),)),
            Section("How it was done", words=_HOW),
        ),
    )


def sources_table(budget: Budget) -> Table:
    """What each source adds, and all together."""
    rows = [
        (source.title, source.kind, *_cells(budget.sources[name], budget))
        for name, source in SOURCES.items()
    ]
    for kind, amounts in budget.kinds.items():
        rows.append((f"{kind.capitalize()}, in quadrature", "sum", *_figures(amounts, budget), ""))
    total = _figures(budget.total, budget)
    rows.append(("All, in quadrature", "sum", *total, ""))
    rows.append(("All on, in one run", "run", *_cells(budget.whole, budget)))
    columns = (
        Column("source"),
        Column("kind"),
        Column("position, mm", _LENGTH),
        Column("from", _LENGTH),
        Column("to, mm", _LENGTH),
        Column("% of height", _LENGTH),
        Column("height, mm", _LENGTH),
        Column("across, mm", _LENGTH),
        Column("attitude, °", _DEGREES),
        Column("told from nothing"),
        Column("full poses"),
    )
    caption = (
        f"Root mean squares of {budget.order.frames} frames, each source by itself; from and to "
        "are 95 % confidence of the position"
    )
    return Table("sources", caption, columns, tuple(rows))


def _cells(found: Contribution, budget: Budget) -> tuple[Cell, ...]:
    return *_figures(found.amounts, budget), f"{found.full} of {budget.order.frames}"


def _figures(amounts: tuple[Amount, ...] | None, budget: Budget) -> tuple[Cell, ...]:
    if amounts is None:
        return (None,) * 7 + ("",)
    by_name = dict(zip(MEASURES, amounts, strict=True))
    position = by_name["position"]
    return (
        position.value,
        position.low,
        position.high,
        100 * position.value / budget.order.height_mm,
        by_name["height"].value,
        by_name["across"].value,
        by_name["attitude"].value,
        "yes" if position.is_resolved else "no",
    )


def changes_table(budget: Budget) -> Table:
    """What each change would do to the sum in quadrature."""
    rows = [
        (
            effect.change.title,
            SOURCES[effect.change.source].title,
            None if effect.after_mm is None else effect.after_mm.value,
            *(
                (None,) * 3
                if effect.after_mm is None
                else (effect.gain_mm, effect.gain_low_mm, effect.gain_high_mm)
            ),
            f"{effect.read} of {budget.order.frames}",
        )
        for effect in budget.effects
    ]
    columns = (
        Column("change"),
        Column("source"),
        Column("sum after, mm", _LENGTH),
        Column("gain, mm", _LENGTH),
        Column("from", _LENGTH),
        Column("to, mm", _LENGTH),
        Column("full poses"),
    )
    caption = (
        "The source that a change is about was simulated anew and put into the sum in quadrature "
        "of the position's error; from and to are 95 % confidence of the gain"
    )
    return Table("changes", caption, columns, tuple(rows))


def _figure(budget: Budget) -> Figure:
    bars = [_bar(source.title, source.kind, budget.sources[x]) for x, source in SOURCES.items()]
    total = None if budget.total is None else budget.total[0]
    bars.append(Bar("All, in quadrature", "together", total))
    bars.append(_bar("All on, in one run", "together", budget.whole))
    words = "; ".join(
        f"{bar.title} {'not measured' if bar.amount is None else f'{bar.amount.value:.3g} mm'}"
        for bar in bars
    )
    caption = f"Error of the position at {budget.order.height_mm:g} mm, root mean square"
    return Figure("bars", ".svg", bars_svg(bars, "mm"), caption, words)


def _bar(title: str, kind: str, found: Contribution) -> Bar:
    return Bar(title, kind, None if found.amounts is None else found.amounts[0])


def _conditions(budget: Budget) -> Table:
    conditions = budget.order.conditions
    rows = [
        (name, f"{getattr(conditions, name):g}", each.unit, each.meaning, each.reason)
        for name, each in QUANTITIES.items()
    ]
    rows.append(("codec", budget.order.codec, "", "of the stream", "usual"))
    heads = ("quantity", "size", "unit", "what it is", "why the default is what it is")
    return Table("conditions", "Sizes of all sources", tuple(map(Column, heads)), tuple(rows))
