"""An output and an autopilot on one link, moved on step by step with a clock of the test's."""

from __future__ import annotations

import socket
from typing import Any

import numpy as np
from autopilot_end import AutopilotClockTruth, AutopilotEnd, ManualClock, udp_end
from landing_truth import LandingTruth
from pymavlink.dialects.v20 import common

from padstudio.geometry.pose import Pose
from padstudio.live.outputs.mavlink.address import parse_address
from padstudio.live.outputs.mavlink.output import MavlinkOutput
from padstudio.live.outputs.mavlink.settings import MavlinkSettings
from padstudio.live.reports.report import LiveReport


class Flight:
    """The session's end of the link and the autopilot's, over UDP on this machine."""

    def __init__(
        self,
        *,
        autopilot: int = common.MAV_AUTOPILOT_ARDUPILOTMEGA,
        truth: LandingTruth | None = None,
        system: int = 1,
        key: bytes | None = None,
        **settings: Any,
    ) -> None:
        self.now = ManualClock()
        self.shows = AutopilotClockTruth()
        self.truth = truth or LandingTruth()
        self.end: AutopilotEnd
        self.socket: socket.socket
        self.end, port, self.socket = udp_end(autopilot=autopilot, system=system, key=key)
        self.sent: list[tuple[LiveReport, float]] = []
        self.told: list[str] = []
        self.output = MavlinkOutput(
            MavlinkSettings(
                address=parse_address(f"udpout:127.0.0.1:{port}"),
                **{"max_hz": 1000.0, "signing_key": key} | settings,
            ),
            sent=lambda report, sent_s: self.sent.append((report, sent_s)),
            tell=self.told.append,
            now=self.now,
        )
        self.delays = np.random.default_rng(5)

    def close(self) -> None:
        self.output.close()
        self.socket.close()

    def step(self) -> list[Any]:
        """Let the output do what is due; gives what the autopilot hears of it."""
        self.output.step()
        return self.end.read()

    def meet(self) -> None:
        """The output speaks first, and hears the autopilot."""
        self.step()
        self.end.heartbeat()
        self.step()

    def answer(self, heard: list[Any]) -> None:
        """Answer questions of the clock, slower on the way back than there."""
        for message in heard:
            if message.get_type() == "TIMESYNC" and message.tc1 == 0:
                there_s, back_s = 0.001 + self.delays.exponential((0.002, 0.008))
                self.now.advance(there_s)
                shown_ns = round(self.shows.at(self.now.now_s) * 1e9)
                self.now.advance(back_s)
                self.end.send(common.MAVLink_timesync_message(shown_ns, message.ts1))
                self.output.step()

    def pass_time(self, seconds: float) -> None:
        """Let time pass, with heartbeats and answers."""
        until_s = self.now.now_s + seconds
        beat_s = self.now.now_s
        while self.now.now_s < until_s:
            if self.now.now_s >= beat_s:
                self.end.heartbeat()
                beat_s += 1.0
            self.answer(self.step())
            self.now.advance(0.05)

    def stream(self, taken_s: float, *, attitude: str = "ATTITUDE_QUATERNION") -> None:
        """Where the vehicle is at a time of ours, as the autopilot streams it, and a bit after."""
        for by_ms in (-20, 0, 20):
            # On whole milliseconds of the autopilot's clock, as it tells them.
            boot_ms = round(self.shows.at(taken_s) * 1e3) + by_ms
            time_s = (boot_ms / 1e3 - self.shows.offset_s) / (1 + self.shows.drift)
            T = self.truth.T_local_body(time_s)
            self.end.send(
                common.MAVLink_local_position_ned_message(boot_ms, *T[:3, 3], 0.0, 0.0, 0.0)
            )
            pose = Pose(T[:3, 3], T[:3, :3])
            if attitude == "ATTITUDE":
                angles = np.radians(pose.euler_deg)
                self.end.send(common.MAVLink_attitude_message(boot_ms, *angles, 0.0, 0.0, 0.0))
            else:
                x, y, z, w = pose.quaternion_xyzw
                self.end.send(
                    common.MAVLink_attitude_quaternion_message(boot_ms, w, x, y, z, 0.0, 0.0, 0.0)
                )
