"""The tables of the shoot-out, in Markdown."""

from __future__ import annotations

from typing import Any

import score


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{value:.4f}"


def show(report: dict[str, Any]) -> None:
    """Print the tables in Markdown."""
    readers: dict[str, Any] = report["readers"]
    print("\nverdicts; position error in percent of the height; good from … to in the descents")
    _head("reader", "frames", *score.VERDICTS, "error", "95th", "heights", "false without board")
    for name, figures in readers.items():
        total, heights = figures["total"], figures["heights_mm"]
        reach = "–" if heights is None else f"{heights[0] / 1000:.3g} … {heights[1] / 1000:.3g} m"
        foreign = figures["groups"].get("foreign")
        false = "–" if foreign is None else f"{foreign['false']} of {foreign['frames']}"
        counts = " | ".join(str(total[word]) for word in ("frames", *score.VERDICTS))
        errors = f"{_percent(total['median_percent'])} | {_percent(total['p95_percent'])}"
        print(f"| {name} | {counts} | {errors} | {reach} | {false} |")
    groups = list(dict.fromkeys(g for f in readers.values() for g in f["groups"] if g != "foreign"))
    print("\ngood of all frames, and median error in percent of the height")
    _head("reader", *groups)
    for name, figures in readers.items():
        cells = [_cell(figures["groups"].get(group)) for group in groups]
        print(f"| {name} | " + " | ".join(cells) + " |")
    print("\nmilliseconds a frame: median, 95th percentile; CPU is of all threads")
    _head("reader", "1 thread", "95th", "CPU", "95th", "2 threads", "95th", "CPU", "95th")
    for name, figures in [*readers.items(), *report["footage"].items()]:
        print(f"| {name} | {_clocks(figures['one_thread'])} | {_clocks(figures['two_threads'])} |")


def _cell(group: dict[str, Any] | None) -> str:
    if group is None:
        return "–"
    share = f"{group['good']} of {group['frames']}"
    false = f", {group['false']} false" if group["false"] else ""
    return share + false + (f" ({_percent(group['median_percent'])})" if group["good"] else "")


def _clocks(times: dict[str, Any]) -> str:
    values = [times[clock][word] for clock in ("wall_ms", "cpu_ms") for word in ("median", "p95")]
    return " | ".join(f"{value:.1f}" for value in values)


def _head(*columns: str) -> None:
    print("\n| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|")
