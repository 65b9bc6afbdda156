"""The autopilot at the other end: who it is, what its clock shows, where its vehicle was."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import common

from padstudio.autopilot.clock import AutopilotClock
from padstudio.autopilot.recent import RecentTrack
from padstudio.media.telemetry.vehicle_log import quaternion_wxyz

# Without a heartbeat for so long it is gone.
_GONE_S = 5.0
# Whoever else may name an autopilot.
_NO_VEHICLES = (
    common.MAV_TYPE_GCS,
    common.MAV_TYPE_ANTENNA_TRACKER,
    common.MAV_TYPE_ONBOARD_CONTROLLER,
    common.MAV_TYPE_GIMBAL,
    common.MAV_TYPE_CAMERA,
    common.MAV_TYPE_ADSB,
)
# Questions of the clock: many at first, then enough to follow it.
_FIRST_QUESTIONS, _FIRST_PAUSE_S, _PAUSE_S = 50, 0.1, 0.5
_QUESTIONS_KEPT = 32
# What a local target needs is asked for where it does not come, or too seldom.
_POSITION = common.MAVLINK_MSG_ID_LOCAL_POSITION_NED
_ATTITUDE = common.MAVLINK_MSG_ID_ATTITUDE_QUATERNION
_STREAM_HZ, _ASK_AFTER_S, _ASK_AGAIN_S = 30, 2.0, 5.0
# It comes if so many messages came in the last second.
_LEAST_A_SECOND = 5

Tell = Callable[[str], None]


class Peer:
    """What is known of the autopilot, from its messages.

    Parameters
    ----------
    system_id : int or None
        Of the vehicle; None for the first autopilot that is heard.
    """

    def __init__(self, system_id: int | None) -> None:
        self.clock = AutopilotClock()
        self.track = RecentTrack()
        #: System and component.
        self.ids: tuple[int, int] | None = None
        #: MAV_AUTOPILOT of its heartbeat.
        self.kind: int | None = None
        self.others: set[int] = set()
        self._wanted = system_id
        self._heard_s = 0.0
        self._questions: deque[tuple[int, float]] = deque(maxlen=_QUESTIONS_KEPT)
        self._ask_clock_s, self._asked = 0.0, 0
        self._ask_streams_s: float | None = None
        self._came = _no_times()
        self._quaternion_s = -1.0

    def is_heard(self, now_s: float) -> bool:
        """Whether its heartbeat comes."""
        return self.ids is not None and now_s - self._heard_s <= _GONE_S

    @property
    def name(self) -> str:
        """Of the autopilot's kind, as MAVLink calls it."""
        if self.kind is None:
            return "none"
        entry = common.enums["MAV_AUTOPILOT"].get(self.kind)
        return str(entry.name) if entry else f"MAV_AUTOPILOT {self.kind}"

    def take(self, message: Any, arrived_s: float) -> Any | None:
        """Learn from a message; gives an answer to send, if it asks for one."""
        ids = message.get_srcSystem(), message.get_srcComponent()
        if message.get_type() == "HEARTBEAT":
            self._heartbeat(message, ids, arrived_s)
        elif ids == self.ids:
            match message.get_type():
                case "TIMESYNC":
                    return self._timesync(message, arrived_s)
                case "LOCAL_POSITION_NED":
                    place = np.array([message.x, message.y, message.z])
                    self.track.position(message.time_boot_ms / 1000, place)
                    self._came[_POSITION].append(arrived_s)
                case "ATTITUDE_QUATERNION":
                    turn = np.array([message.q1, message.q2, message.q3, message.q4])
                    self.track.attitude(message.time_boot_ms / 1000, turn)
                    self._came[_ATTITUDE].append(arrived_s)
                    self._quaternion_s = arrived_s
                case "ATTITUDE" if arrived_s - self._quaternion_s > 1.0:
                    angles = (np.array([a]) for a in (message.roll, message.pitch, message.yaw))
                    self.track.attitude(message.time_boot_ms / 1000, quaternion_wxyz(*angles)[0])
                    self._came[_ATTITUDE].append(arrived_s)
        return None

    def questions(self, now_s: float, *, needs_track: bool) -> Iterator[Any]:
        """What is due to be asked of it."""
        if not self.is_heard(now_s) or self.ids is None:
            return
        if now_s >= self._ask_clock_s:
            self._asked += 1
            pause = _FIRST_PAUSE_S if self._asked < _FIRST_QUESTIONS else _PAUSE_S
            self._ask_clock_s = now_s + pause
            stamp = round(now_s * 1e9)
            self._questions.append((stamp, now_s))
            yield common.MAVLink_timesync_message(0, stamp)
        if needs_track:
            yield from self._streams(now_s)

    def _heartbeat(self, message: Any, ids: tuple[int, int], arrived_s: float) -> None:
        is_none = message.autopilot == common.MAV_AUTOPILOT_INVALID
        if is_none or message.type in _NO_VEHICLES:
            return
        if self._wanted is not None and ids[0] != self._wanted:
            self.others.add(ids[0])
            return
        if ids != self.ids:
            if self.ids is not None and self.is_heard(arrived_s):
                self.others |= {ids[0]} - {self.ids[0]}
                return
            self._begin(ids)
        self.kind, self._heard_s = message.autopilot, arrived_s

    def _begin(self, ids: tuple[int, int]) -> None:
        """Another autopilot: nothing of the one before holds."""
        self.ids = ids
        self.clock, self.track = AutopilotClock(), RecentTrack()
        self._questions.clear()
        self._ask_clock_s, self._asked = 0.0, 0
        self._ask_streams_s, self._came = None, _no_times()
        self._quaternion_s = -1.0

    def _timesync(self, message: Any, arrived_s: float) -> Any | None:
        if message.tc1:
            sent_s = dict(self._questions).get(message.ts1)
            if sent_s is not None:
                self.clock.take(sent_s, message.tc1, arrived_s)
                if self.clock.state(arrived_s).answers == 1:
                    self._asked = 0
            return None
        # PX4 adds to our times by how much our clock differs from its own, as it finds by its
        # questions. Our times are on its clock already, so its questions are answered by that.
        shown = self.clock.at_ns(arrived_s)
        return None if shown is None else common.MAVLink_timesync_message(shown, message.ts1)

    def _streams(self, now_s: float) -> Iterator[Any]:
        if self._ask_streams_s is None:
            self._ask_streams_s = now_s + _ASK_AFTER_S
        if now_s < self._ask_streams_s or self.ids is None:
            return
        self._ask_streams_s = now_s + _ASK_AGAIN_S
        for number, times_s in self._came.items():
            if len(times_s) < _LEAST_A_SECOND or now_s - times_s[0] > 1.0:
                yield common.MAVLink_command_long_message(
                    *self.ids,
                    common.MAV_CMD_SET_MESSAGE_INTERVAL,
                    0,
                    number,
                    1e6 / _STREAM_HZ,
                    *[0.0] * 5,
                )


def _no_times() -> dict[int, deque[float]]:
    return {number: deque(maxlen=_LEAST_A_SECOND) for number in (_POSITION, _ATTITUDE)}
