"""Which pad's poses an export holds, where a flight or a file has those of several."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Any

from padstudio.errors import SpecError, shown

Record = dict[str, Any]

#: Forms that say of each pose which pad it is of.
ANY_PADS = ("csv", "jsonl")


def check_pad(form: str, pads: Collection[str], chosen: str | None) -> None:
    """Refuse poses of several pads, each in its own frame, where a form holds one trajectory.

    Parameters
    ----------
    form : str
    pads : collection of str
        Identities of those that there are.
    chosen : str or None
        The one whose poses are wanted.

    Raises
    ------
    SpecError
    """
    listed = ", ".join(sorted(pads))
    if chosen is not None and chosen not in pads:
        raise SpecError(
            f"there is no pad {shown(chosen)} among {listed or 'the poses'}; choose one of them",
            code="unknown_pad",
        )
    if chosen is None and len(pads) > 1 and form not in ANY_PADS:
        raise SpecError(
            f"there are poses of {len(pads)} pads ({listed}), and {form} holds those of one; "
            "choose one by its pad_id",
            code="several_pads",
        )


def of_pad(records: Iterable[Record], chosen: str | None) -> Iterator[Record]:
    """Records without the poses of other pads than the chosen one; all where none is."""
    for record in records:
        if chosen is None or record.get("pad_id", chosen) == chosen:
            yield record
