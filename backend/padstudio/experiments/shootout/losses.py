"""Where another board is better than the user's pad."""

from __future__ import annotations

from collections.abc import Iterator

from padstudio.experiments.shootout import reading
from padstudio.experiments.shootout.contest import Contest
from padstudio.experiments.shootout.entry import PAD, Entry
from padstudio.experiments.shootout.scores import Summary, percentile, summarise

#: Board, settings, in what, its figure, the pad's.
Loss = tuple[str, str, str, str, str]


def losses(contest: Contest) -> Iterator[Loss]:
    """All that another board did better than the pad, board by board.

    The pad stands with the reader of single frames, as all others are; times count only where the
    machine did nothing else.
    """
    pad = next(entry for entry in contest.entries if entry.board == PAD)
    by_tilt = contest.order.by_tilt
    own = summarise(pad.outcomes, by_tilt=by_tilt)
    for entry in contest.entries:
        if entry.board == PAD:
            continue
        sums = summarise(entry.outcomes, by_tilt=by_tilt)
        found = [*_counts(entry, pad, sums, own), *_reach(sums, own, by_tilt), *_error(entry, pad)]
        if contest.beside.alone and entry.setting in reading.TIMED:
            found += _time(entry, pad)
        for what, its, pads in found:
            yield entry.title, entry.setting, what, its, pads


def _counts(
    entry: Entry, pad: Entry, sums: Summary, own: Summary
) -> Iterator[tuple[str, str, str]]:
    if sums.read > own.read:
        yield "frames read", str(sums.read), str(own.read)
    if sums.false < own.false:
        yield "false poses", str(sums.false), str(own.false)
    if len(entry.mistaken) < len(pad.mistaken):
        counts = len(entry.mistaken), len(pad.mistaken)
        yield "false poses without the board", str(counts[0]), str(counts[1])
    only = [
        its
        for its, pads in zip(entry.outcomes, pad.outcomes, strict=True)
        if its.verdict == "read" and pads.verdict != "read"
    ]
    if only:
        heights = [outcome.height_mm / 1000 for outcome in only]
        where = f"{min(heights):.3g} … {max(heights):.3g} m"
        yield "frames that the pad does not read", f"{len(only)} ({where})", "0"


def _reach(sums: Summary, own: Summary, by_tilt: bool) -> Iterator[tuple[str, str, str]]:
    if sums.lowest is None or sums.highest is None:
        return
    unit, scale = ("°", 1.0) if by_tilt else (" m", 1000.0)

    def shown(value: float | None) -> str:
        return "–" if value is None else f"{value / scale:.3g}{unit}"

    if own.highest is None or sums.highest > own.highest:
        yield f"largest {'tilt' if by_tilt else 'height'}", shown(sums.highest), shown(own.highest)
    if not by_tilt and (own.lowest is None or sums.lowest < own.lowest):
        yield "least height", shown(sums.lowest), shown(own.lowest)
    if sums.ratio is not None and (own.ratio is None or sums.ratio > own.ratio):
        yield "range ratio", f"{sums.ratio:.0f}", f"{own.ratio:.0f}" if own.ratio else "–"


def _error(entry: Entry, pad: Entry) -> Iterator[tuple[str, str, str]]:
    """Over the frames that both read: others would compare near frames with far ones."""
    both = [
        (its, pads)
        for its, pads in zip(entry.outcomes, pad.outcomes, strict=True)
        if its.verdict == "read" and pads.verdict == "read"
    ]
    its = percentile((one.error_percent for one, _ in both), 50)
    pads = percentile((one.error_percent for _, one in both), 50)
    if its is not None and pads is not None and its < pads:
        name = f"median error over the {len(both)} frames that both read"
        yield name, f"{its:.4f} %", f"{pads:.4f} %"


def _time(entry: Entry, pad: Entry) -> Iterator[tuple[str, str, str]]:
    its, pads = (percentile((o.cpu_ms for o in e.outcomes), 50) for e in (entry, pad))
    if its is not None and pads is not None and its < pads:
        yield "median time", f"{its:.1f} ms", f"{pads:.1f} ms"
