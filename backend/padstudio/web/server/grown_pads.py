"""Pads that were grown lately: the same code is not grown again for another size or name."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

from padstudio.workers.pads import Design

# What a spec says beside the code itself.
_SIZES = ("name", "cell_mm", "quiet_mm")


class GrownPads:
    """The designs grown last, by what their codes depend on; those not asked for longest go first.

    Parameters
    ----------
    keep_bytes : int
        Of pad files; the newest stays only within it.
    """

    def __init__(self, keep_bytes: int = 64_000_000) -> None:
        self._keep_bytes = keep_bytes
        self._made: OrderedDict[str, tuple[dict[str, Any], Design]] = OrderedDict()
        self._lock = threading.Lock()

    def find(self, spec: Mapping[str, Any]) -> Design | None:
        """The design of a spec's code, of whichever size and name; None where it is not kept."""
        with self._lock:
            key = _code_of(spec)
            if key not in self._made:
                return None
            self._made.move_to_end(key)
            return self._made[key][1]

    def holds(self, spec: Mapping[str, Any]) -> bool:
        """True if the kept design is of the spec's size and name, too."""
        with self._lock:
            kept = self._made.get(_code_of(spec))
            return kept is not None and kept[0] == _sizes_of(spec)

    def keep(self, spec: Mapping[str, Any], made: Design) -> None:
        """Keep what was grown for a spec; without a seed each growth is another pad."""
        if spec.get("seed") is None:
            return
        with self._lock:
            key = _code_of(spec)
            self._made[key] = (_sizes_of(spec), made)
            self._made.move_to_end(key)
            while self._made and self._bytes() > self._keep_bytes:
                self._made.popitem(last=False)

    def _bytes(self) -> int:
        return sum(len(made.content) for _, made in self._made.values())


def _code_of(spec: Mapping[str, Any]) -> str:
    return repr(sorted((name, value) for name, value in spec.items() if name not in _SIZES))


def _sizes_of(spec: Mapping[str, Any]) -> dict[str, Any]:
    return {name: spec[name] for name in _SIZES}
