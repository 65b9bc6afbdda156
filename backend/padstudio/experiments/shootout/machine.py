"""What else the machine did during a run: whether times may be compared."""

from __future__ import annotations

import os
import platform
import time
from dataclasses import dataclass, field
from pathlib import Path

#: Cores that others may have been at, on the average, for times to count as measured alone.
ALONE_CORES = 0.1


def _busy_s() -> float | None:
    """Time that all cores together were at work, s; None where the system does not say."""
    try:
        words = Path("/proc/stat").read_text(encoding="ascii").split("\n", 1)[0].split()
    except (OSError, ValueError):
        return None
    # proc(5): user, nice, system, idle, iowait, irq, softirq, steal.
    ticks = [int(word) for word in words[1:9]]
    return (sum(ticks) - ticks[3] - ticks[4]) / os.sysconf("SC_CLK_TCK")


def _own_s() -> float:
    """Of this process, and of its children that are over."""
    return sum(os.times()[:4])


@dataclass
class Beside:
    """Adds up what others computed while something ran here, from its making until `end`.

    Attributes
    ----------
    cores : float or None
        Cores that others kept busy, on the average; None where that is not known.
    """

    cores: float | None = None
    _began: tuple[float | None, float, float] = field(
        default_factory=lambda: (_busy_s(), _own_s(), time.monotonic())
    )

    def end(self) -> None:
        """Stop counting."""
        before, own_s, began_s = self._began
        busy_s = _busy_s()
        if before is not None and busy_s is not None:
            others_s = busy_s - before - (_own_s() - own_s)
            self.cores = max(0.0, others_s / max(time.monotonic() - began_s, 1e-3))

    @property
    def alone(self) -> bool:
        """Whether nothing else was at work that could have slowed readers down."""
        return self.cores is not None and self.cores <= ALONE_CORES


def processor() -> str:
    """The processor's name, and how many cores there are."""
    name = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
        name = next(names, name)
    except (OSError, UnicodeDecodeError):
        pass
    return f"{name}, {os.cpu_count()} cores"
