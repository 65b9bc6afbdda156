"""What became of the poses that were to go to an autopilot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from padstudio.autopilot.clock import ClockState
from padstudio.live.outputs.mavlink.link import LinkCounts

#: Why a pose was not sent: its frame was taken too long ago; others were sent just before; the
#: autopilot is not heard, or of no known kind; where its vehicle was, or its clock, is not known;
#: its attitude cannot be used; the link does not take it.
Withheld = Literal["too_old", "over_rate", "no_autopilot", "no_vehicle_pose", "no_attitude", "link"]


@dataclass(frozen=True)
class MavlinkStats:
    """As of a moment.

    Attributes
    ----------
    address : str
    is_open : bool
    detail : str
        Why the link is not open; empty while it is.
    autopilot : str
        MAVLink's name of its kind; "none" where none is heard.
    system_id : int or None
        Of the autopilot.
    profile : str or None
        In which poses are sent; None where it is not known yet.
    sent : int
        Poses.
    sent_unsynchronised : int
        Of these, those with a time of our own clock, as the autopilot's was not known.
    withheld : mapping
        Poses that were not sent, by why.
    link : LinkCounts
        Messages of every kind.
    clock : ClockState
    """

    address: str
    is_open: bool
    detail: str
    autopilot: str
    system_id: int | None
    profile: str | None
    sent: int
    sent_unsynchronised: int
    withheld: Mapping[Withheld, int]
    link: LinkCounts
    clock: ClockState
