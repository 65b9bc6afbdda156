"""All parameters of the detector: frozen, keyword-only, checked where they are made."""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.errors import SpecError


@dataclass(frozen=True, kw_only=True)
class DetectorParams:
    """Parameters of the whole pipeline.

    Attributes
    ----------
    log10_false_alarm : float
        A pose is given only where the bound on the chance of a false match is below this power
        of ten.
    """

    log10_false_alarm: float = -7.0

    def __post_init__(self) -> None:
        if not -300 <= self.log10_false_alarm <= -2:
            raise SpecError(
                f"log10_false_alarm is {self.log10_false_alarm}; it must lie within -300 … -2"
            )
