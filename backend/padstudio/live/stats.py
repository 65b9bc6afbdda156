"""How a session fares, as figures for programs and as lines for people."""

from __future__ import annotations

from typing import Any

from padstudio.live.reports.source import FrameSource
from padstudio.live.session import LiveSession


def stats_of(session: LiveSession, source: FrameSource) -> dict[str, Any]:
    """All figures; JSON-serialisable."""
    state = source.state
    return {
        "sight": session.sight,
        "stream": {
            "phase": state.phase,
            "detail": state.detail,
            "code": state.code,
            "frames": state.frames,
            "dropped": state.dropped,
            "skipped": state.skipped,
            "damaged": state.damaged,
            "connections": state.connections,
            "size_px": None if state.size_px is None else list(state.size_px),
            "codec": state.codec,
        },
        "counts": session.counts.to_dict(),
        "latency_ms": session.latency.to_dict(),
    }


def line_for_people(stats: dict[str, Any]) -> str:
    """One line of the figures that tell most."""
    counts, stream = stats["counts"], stats["stream"]
    share = f"{100 * counts['poses'] / counts['frames']:.1f} %" if counts["frames"] else "–"
    gone = f"{counts['dropped']} dropped"
    if stream["skipped"]:
        gone += f", {stream['skipped']} skipped before decoding"
    parts = [
        stats["sight"] if stream["phase"] == "open" else stream["phase"],
        f"{counts['frames']} frames, {share} read, {gone}",
    ]
    for name, title in (
        ("decoded_to_posed", "decoded → pose"),
        ("decoded_to_sent", "decoded → sent"),
        ("captured_to_sent", "captured → sent"),
    ):
        stage = stats["latency_ms"].get(name)
        if stage is not None:
            parts.append(f"{title} {stage['median_ms']:.1f} ms (95 %: {stage['p95_ms']:.1f})")
    return " · ".join(parts)
