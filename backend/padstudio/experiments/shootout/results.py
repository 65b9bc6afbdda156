"""What a shoot-out found, as sections of its report."""

from __future__ import annotations

from padstudio.experiments.report import Cell, Column, Figure, Section, Table
from padstudio.experiments.shootout import drawings, reading
from padstudio.experiments.shootout.contest import Contest, shown_views
from padstudio.experiments.shootout.entry import Entry
from padstudio.experiments.shootout.losses import losses
from padstudio.experiments.shootout.machine import processor
from padstudio.experiments.shootout.scores import percentile, summarise

_TIMING = (
    "Times are of pictures already decoded, one thread, with each reader's fast settings, in a "
    "process of its own that had read the first frame three times; every frame is read twice, and "
    "the second time counts (followed frames once). Processor time; the clock's where nothing "
    "else runs is the same."
)


def verdicts(contest: Contest) -> Section:
    """The table of all readers, the strips, and the chart of errors."""
    troubles = tuple(
        f"{entry.title}, {entry.setting}: {' '.join(entry.troubles)}"
        for entry in contest.entries
        if entry.troubles
    )
    return Section("Verdicts", troubles, tables=(_table(contest),), figures=_charts(contest))


def _table(contest: Contest) -> Table:
    by_tilt = contest.order.by_tilt
    unit, scale = ("°", 1.0) if by_tilt else ("m", 1000.0)
    columns = [Column(title) for title in ("board", "settings", "read", "false", "missed")]
    columns += [Column("error %", 4), Column("95th %", 4), Column("attitude °", 3)]
    columns += [Column(f"from {unit}", 3), Column(f"to {unit}", 3)]
    columns += [Column("ratio", 0), Column("false without it")]
    rows = []
    for entry in contest.entries:
        sums = summarise(entry.outcomes, by_tilt=by_tilt)
        counts = (sums.read, sums.false, sums.missed)
        sizes = (sums.median_percent, sums.p95_percent, sums.median_deg)
        span = [None if v is None else v / scale for v in (sums.lowest, sums.highest)]
        rows.append(
            (entry.title, entry.setting, *counts, *sizes, *span, sums.ratio, _mistaken(entry))
        )
    over = "tilt" if by_tilt else "height"
    caption = (
        "Frames by verdict; errors of those that were read (position in percent of the distance, "
        f"median and 95th percentile; attitude, median); lowest and highest {over} read and their "
        "ratio; poses in frames of bare ground and of the other boards."
    )
    return Table("boards", caption, tuple(columns), tuple(rows))


def _charts(contest: Contest) -> tuple[Figure, Figure]:
    by_tilt, entries = contest.order.by_tilt, contest.entries
    axis = drawings.axis_of(entries[0].outcomes, by_tilt=by_tilt)
    over = "tilt" if by_tilt else "height"
    strips = Figure(
        "strips",
        ".svg",
        drawings.strips(entries, axis),
        f"Every frame at its {over}: a bar where it was read, a cross where the pose is false, a "
        "ring where it was missed.",
        f"A strip a reader over the {over}; the figures stand in the table of frames.",
    )
    errors = Figure(
        "errors",
        ".svg",
        drawings.errors(entries, axis),
        f"Position error of the frames that were read over the {over}, in even ratios.",
        f"A line a reader: error over the {over}; the figures stand in the table of frames.",
    )
    return strips, errors


def _mistaken(entry: Entry) -> str:
    """How many frames without its board a reader found it in, and of what these are."""
    of = f" ({', '.join(dict.fromkeys(entry.mistaken))})" if entry.mistaken else ""
    return f"{len(entry.mistaken)} of {entry.strangers}{of}"


def better_boards(contest: Contest) -> Section:
    """Where the pad loses."""
    rows = tuple(losses(contest))
    if not rows:
        words = ("On this flight no board was better than the pad in anything that is compared.",)
        return Section("Where another board is better", words)
    columns = tuple(Column(title) for title in ("board", "settings", "in", "its", "the pad's"))
    caption = (
        "Everything in which a board is better than the pad, read frame by frame: frames read, "
        "false poses, reach, frames that the pad does not read, the error over the frames that "
        "both read, and, where times may be compared, time."
    )
    table = Table("losses", caption, columns, rows)
    return Section("Where another board is better", tables=(table,))


def times(contest: Contest) -> Section:
    """Milliseconds, where they can be compared; how they were taken, everywhere."""
    beside = contest.beside
    if beside.cores is None:
        why = "This system does not say what else was at work, so times are not compared."
        return Section("Times", (_TIMING, why))
    found = f"Other work kept {beside.cores:.2f} cores busy meanwhile ({processor()})."
    if not beside.alone:
        why = "So times are not compared; run it again on a machine that does nothing else."
        return Section("Times", (_TIMING, found, why))
    rows: list[tuple[Cell, ...]] = []
    for entry in contest.entries:
        if entry.setting in reading.TIMED:
            spans = [percentile([o.cpu_ms for o in entry.outcomes], q) for q in (50, 5, 95)]
            wall = percentile([o.wall_ms for o in entry.outcomes], 50)
            rows.append((entry.title, entry.setting, *spans, wall))
    heads = ("median ms", "5th ms", "95th ms", "clock ms")
    columns = (Column("board"), Column("settings"), *(Column(head, 1) for head in heads))
    caption = "Milliseconds a frame: median, 5th and 95th percentile; the clock's median."
    return Section(
        "Times", (_TIMING, found), tables=(Table("times", caption, columns, tuple(rows)),)
    )


def frames(contest: Contest) -> Section:
    """What every reader made of every frame."""
    columns = [Column("frame"), Column("height m", 3), Column("tilt °", 1)]
    columns += [Column(f"{entry.title}, {entry.setting}", 4) for entry in contest.entries]
    rows = []
    for number, outcomes in enumerate(zip(*(e.outcomes for e in contest.entries), strict=True), 1):
        cells = [o.error_percent if o.verdict == "read" else o.verdict for o in outcomes]
        rows.append((number, outcomes[0].height_mm / 1000, outcomes[0].tilt_deg, *cells))
    caption = "Every frame: the position's error in percent of the distance, or the verdict."
    return Section("Frames", tables=(Table("frames", caption, tuple(columns), tuple(rows)),))


def pictures(contest: Contest) -> Section:
    """A few frames of each board."""
    figures = []
    for board, taken in contest.pictures.items():
        entry = next(entry for entry in contest.entries if entry.board == board)
        told = [
            f"{entry.outcomes[k].height_mm / 1000:.3g} m {entry.outcomes[k].verdict}"
            for k in shown_views(contest.order.frames)
        ]
        caption = f"{entry.title}, {entry.setting}: {'; '.join(told)}."
        data = drawings.side_by_side(taken)
        seen = f"The board {entry.title} on the ground in {len(taken)} frames."
        figures.append(Figure(f"frames-{board}", ".webp", data, caption, seen))
    words = (
        "First, middle and last frame of each board; the line is the board's edge as the pose that "
        "was found has it.",
    )
    return Section("Pictures", words, figures=tuple(figures))
