"""What can exist: counts of windows, told before a search begins."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import comb, isqrt
from typing import Any, Literal

from padstudio.errors import LimitError, SpecError
from padstudio.pad.coding.search.maximum_length import can_cut
from padstudio.pad.coding.search.spec import FieldSpec

Outlook = Literal["easy", "long", "impossible"]

# One bit a window: 128 MB. Beyond it windows are so many that growth at random does not run dry.
MAX_TABLE_CODES = 2**30
# Hash chains hold this many part entries of windows, 8 bytes each.
MAX_CHAIN_ENTRIES = 2**27
# Windows ruled out, counted as often as they are, per window there is: up to this a search was
# measured to be quick. At greater distances what windows rule out overlaps.
_EASY_LOAD = {1: 0.42, 2: 0.5, 3: 0.62}
_EASY_LOAD_BEYOND = 0.7


@dataclass(frozen=True)
class Bounds:
    """How far a field's property leaves room.

    Attributes
    ----------
    windows_possible : int
        Y^(b²).
    windows_allowed : int
        Windows of which a field can hold each: all, or under rotation those that are not their own
        turn, four turns as one.
    windows_at_most : int
        How many windows a field can hold at the distance asked for (an upper bound).
    windows_needed : int
        Of all fields that the spec asks for.
    share : float
        Needed of at most.
    largest_square : int
        Largest side of a square field, with what goes with it, that the count does not rule out.
    outlook : {"easy", "long", "impossible"}
        "long": near the bound; the search may take long or not end.
    """

    windows_possible: int
    windows_allowed: int
    windows_at_most: int
    windows_needed: int
    share: float
    largest_square: int
    outlook: Outlook

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and texts, for JSON."""
        return asdict(self)


def bounds(spec: FieldSpec) -> Bounds:
    """Count the windows that exist, that a spec's property leaves, and that it needs.

    Notes
    -----
    Distance d bounds the number of windows twice: balls of radius ⌊(d − 1) / 2⌋ round them are
    disjoint (Hamming), and leaving out d − 1 cells keeps them distinct (Singleton). Under rotation
    every window brings its four turns.
    """
    size, levels = spec.window**2, spec.levels
    possible = levels**size
    # A half turn fixes the windows whose cell pairs are equal; a quarter turn fixes some of those.
    symmetric = levels ** ((size + 1) // 2) if spec.turns == 4 else 0
    allowed = (possible - symmetric) // spec.turns
    radius = (spec.distance - 1) // 2
    ball = sum(comb(size, k) * (levels - 1) ** k for k in range(radius + 1))
    packed = min(possible // ball, levels ** (size - spec.distance + 1))
    at_most = min(allowed, packed // spec.turns)
    needed = spec.windows_needed(spec.rows, spec.cols)
    share = needed / at_most if at_most else float("inf")
    if share > 1:
        outlook: Outlook = "impossible"
    else:
        easy = _EASY_LOAD.get(spec.distance, _EASY_LOAD_BEYOND)
        # Of small windows, few sequences are at hand, and none may do.
        sure = spec.window > 3 and cuts_first(spec)
        outlook = "easy" if sure or load(spec) <= easy else "long"
    side = _largest_square(spec, at_most)
    return Bounds(possible, allowed, at_most, needed, share, side, outlook)


def _largest_square(spec: FieldSpec, at_most: int) -> int:
    """Largest side with no more windows than that, by bisection; 0 for none."""
    low, high = spec.window - 1, isqrt(at_most) + spec.window
    while high - low > 1:
        side = (low + high) // 2
        low, high = (side, high) if spec.windows_needed(side, side) <= at_most else (low, side)
    return low if at_most else 0


def check_possible(spec: FieldSpec) -> Bounds:
    """The bounds of a spec that can be searched for.

    Raises
    ------
    SpecError
        If no field can have the property, naming the largest square that might.
    LimitError
        If the search would take more memory than it may.
    """
    found = bounds(spec)
    if found.outlook == "impossible":
        unique = "differ in all turns" if spec.turns == 4 else "differ"
        raise SpecError(
            f"{spec.cells_in_words} need {found.windows_needed} windows of "
            f"{spec.window} x {spec.window} cells that {unique} in at least {spec.distance} "
            f"cells; with {spec.levels} levels there are at most {found.windows_at_most}: "
            f"{_way_out(spec, found)}",
            code="impossible_spec",
            detail=found.to_dict(),
        )
    entries = found.windows_needed * spec.distance
    if not uses_table(spec) and entries > MAX_CHAIN_ENTRIES:
        raise LimitError(
            f"{found.windows_needed} windows at distance {spec.distance} take {entries} table "
            f"entries; the limit is {MAX_CHAIN_ENTRIES}: take a smaller field or a lesser distance",
            detail=found.to_dict(),
        )
    return found


def uses_table(spec: FieldSpec) -> bool:
    """Whether a field is searched over a table of all windows, rather than grown at random."""
    return spec.method == "auto" and spec.levels ** (spec.window**2) <= MAX_TABLE_CODES


def _way_out(spec: FieldSpec, found: Bounds) -> str:
    alone = spec.last_resort if spec.windows <= found.windows_at_most else ""
    if found.largest_square < spec.window:
        return f"take a lesser distance, a larger window or more levels{alone}"
    side = found.largest_square
    lesser = ", a lesser distance" if spec.distance > 1 else ""
    return f"take at most {side} x {side} cells{lesser}, a larger window or more levels{alone}"


def ruled_out(spec: FieldSpec) -> int:
    """Windows nearer than the distance to a window, itself included."""
    changes = range(spec.distance)
    return sum(comb(spec.window**2, k) * (spec.levels - 1) ** k for k in changes)


def load(spec: FieldSpec) -> float:
    """Windows that all fields rule out, counted as often as they are, per window there is.

    Those of another field are ruled out in every turn.
    """
    beside = spec.windows_needed(spec.rows, spec.cols) - spec.windows
    ruled = (spec.windows * spec.turns + beside * 4) * ruled_out(spec)
    return float(ruled / spec.levels ** (spec.window**2))


def cuts_first(spec: FieldSpec) -> bool:
    """Whether the field can be cut from one sequence, with room beside it for the others.

    A sequence heeds no other field, so that those come after it, and find its windows in four turns
    taken.
    """
    if not can_cut(spec):
        return False
    if spec.windows_needed(spec.rows, spec.cols) == spec.windows:
        return True
    used = spec.windows / spec.levels ** (spec.window**2)
    return bool(1 - (1 - used) ** 4 <= _EASY_LOAD[1])
