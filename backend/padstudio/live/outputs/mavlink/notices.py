"""Sentences on the link and the autopilot, for who watches a session."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from padstudio.live.outputs.mavlink import messages
from padstudio.live.outputs.mavlink.compose import needs_track, profile_of
from padstudio.live.outputs.mavlink.link import Link
from padstudio.live.outputs.mavlink.peer import Peer
from padstudio.live.outputs.mavlink.settings import MavlinkSettings
from padstudio.live.outputs.mavlink.stats import Withheld

# Before this it is too early to miss a heartbeat, or answers.
_PATIENCE_S = 4.0
# Poses that were too old with none in between that was not.
_MANY_OLD = 10


class Notices:
    """Says what has changed, each thing once until it changes again.

    Parameters
    ----------
    settings : MavlinkSettings
    start_s : float
        When the link was begun.
    """

    def __init__(self, settings: MavlinkSettings, start_s: float) -> None:
        self._settings, self._start_s = settings, start_s
        self._said: dict[str, str] = {}
        self._heard_s = start_s
        self._missed = 0
        self._sent = self._old = 0

    def changes(
        self, link: Link, peer: Peer, now_s: float, sent: int, withheld: Mapping[Withheld, int]
    ) -> list[str]:
        """What is new to say.

        Parameters
        ----------
        link : Link
        peer : Peer
        now_s : float
        sent : int
            Poses so far.
        withheld : mapping
            Poses so far that were not sent, by why.
        """
        if not peer.is_heard(now_s):
            self._heard_s = now_s
        new = []
        missed = withheld.get("no_vehicle_pose", 0)
        state = [*self._state(link, peer, now_s), *self._poses(sent, withheld.get("too_old", 0))]
        if missed > self._missed:
            state.append(("track", _missing_track(peer, now_s)))
        for topic, text in state:
            if self._said.get(topic, "") != text:
                self._said[topic] = text
                if text:
                    new.append(text)
        self._missed = missed
        return new

    def _state(self, link: Link, peer: Peer, now_s: float) -> Iterator[tuple[str, str]]:
        address = self._settings.address
        if not link.is_open:
            if link.detail:
                yield "link", link.detail
            return
        yield "link", f"{address}: open"
        yield from self._autopilot(peer, now_s)
        if peer.others:
            ids = ", ".join(map(str, sorted(peer.others)))
            text = f"other vehicles are heard and not served: {ids}; choose one by its system id"
            yield "others", text
        if peer.is_heard(now_s):
            yield from self._clock(peer, now_s)

    def _poses(self, sent: int, old: int) -> Iterator[tuple[str, str]]:
        if sent > self._sent:
            self._sent, self._old = sent, old
            yield "age", ""
        elif old - self._old >= _MANY_OLD:
            yield (
                "age",
                "poses are not sent: their frames were taken more than "
                f"{self._settings.max_age_s * 1000:g} ms ago when they are read; lower the "
                "stream's latency, or allow a greater age",
            )

    def _autopilot(self, peer: Peer, now_s: float) -> Iterator[tuple[str, str]]:
        settings = self._settings
        if not peer.is_heard(now_s) or peer.kind is None or peer.ids is None:
            if now_s - self._start_s > _PATIENCE_S:
                yield (
                    "autopilot",
                    f"{settings.address}: no autopilot's heartbeat is heard; see that its port "
                    "speaks MAVLink 2 and sends to here",
                )
            return
        kind = messages.PROFILES.get(peer.kind)
        who = f"vehicle {peer.ids[0]} is heard: {peer.name}"
        if settings.message == "position_estimate":
            yield "autopilot", f"{who}; VISION_POSITION_ESTIMATE is sent"
        elif kind is None and settings.profile == "auto":
            yield (
                "autopilot",
                f"{who}, whose way of LANDING_TARGET is not known: nothing is sent; choose the "
                "profile ardupilot or px4 if it takes one of them",
            )
        elif kind not in (None, profile_of(settings, peer, now_s)):
            yield (
                "autopilot",
                f"{who}, but the profile {settings.profile} is set: it ignores LANDING_TARGET in "
                f"that frame; choose {kind} or auto",
            )
        else:
            yield "autopilot", f"{who}, profile {profile_of(settings, peer, now_s)}"

    def _clock(self, peer: Peer, now_s: float) -> Iterator[tuple[str, str]]:
        state = peer.clock.state(now_s)
        if state.is_known:
            again = f"; it has begun anew {state.restarts} times" if state.restarts else ""
            yield "clock", f"the autopilot's clock is known{again}"
        elif now_s - self._heard_s > _PATIENCE_S:
            ends = (
                "nothing is sent"
                if needs_track(self._settings, profile_of(self._settings, peer, now_s))
                else "times are our own"
            )
            yield "clock", f"the autopilot does not answer TIMESYNC: {ends}"


def _missing_track(peer: Peer, now_s: float) -> str:
    position_s, attitude_s = peer.track.newest_s
    if not peer.clock.state(now_s).is_known:
        what = "its clock is not known yet"
    elif position_s is None or attitude_s is None:
        names = (
            "LOCAL_POSITION_NED" if position_s is None else "",
            "ATTITUDE_QUATERNION or ATTITUDE" if attitude_s is None else "",
        )
        what = f"it sends no {' and no '.join(filter(None, names))}"
    else:
        what = "where its vehicle was comes too seldom or too late"
    return f"poses were not sent: PX4 needs them in its local frame, and {what}"
