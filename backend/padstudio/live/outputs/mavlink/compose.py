"""From a report to the message that says its pose."""

from __future__ import annotations

from typing import Any

from padstudio.autopilot.target import Sight, Target, target_in_body
from padstudio.autopilot.vision import position_estimate_fields
from padstudio.geometry.pose import Pose
from padstudio.live.outputs.mavlink import messages
from padstudio.live.outputs.mavlink.peer import Peer
from padstudio.live.outputs.mavlink.settings import MavlinkSettings
from padstudio.live.outputs.mavlink.stats import Withheld
from padstudio.live.reports.report import LiveReport


def profile_of(settings: MavlinkSettings, peer: Peer, now_s: float) -> str | None:
    """As it was chosen, or as the autopilot that is heard takes it; None where none is known."""
    if settings.profile != "auto":
        return settings.profile
    is_heard = peer.kind is not None and peer.is_heard(now_s)
    return messages.PROFILES.get(peer.kind) if is_heard else None


def needs_track(settings: MavlinkSettings, profile: str | None) -> bool:
    """Whether poses can be sent only where the vehicle's own is known."""
    return settings.message == "landing_target" and profile == "px4"


def message_of(
    report: LiveReport, settings: MavlinkSettings, peer: Peer, profile: str | None
) -> Any | Withheld | None:
    """What says a report's pose; why nothing does; or None where that will be known soon."""
    pose = report.detection.pose
    assert pose is not None
    taken_ns = peer.clock.at_ns(report.frame.taken_s)
    # Until the autopilot's clock is known it is a clock of ours, since boot.
    time_us = max(0, round(report.frame.taken_s * 1e9) if taken_ns is None else taken_ns) // 1000
    if settings.message == "position_estimate":
        return _position_estimate(report, pose, settings, time_us)
    if profile is None:
        return "no_autopilot"
    is_full = report.detection.quality == "full"
    sight = Sight(pose.range_mm / 1000, pose.bearing)
    body = target_in_body(sight, pose if is_full else None, settings.mount)
    target = body if profile == "ardupilot" else _local(body, taken_ns, peer)
    if not isinstance(target, Target):
        return target
    return messages.landing_target(
        sight,
        body,
        target,
        time_us=time_us,
        frame=messages.FRAMES[profile],
        number=settings.target_number,
        pad_size_mm=settings.pad_size_mm,
    )


def _position_estimate(
    report: LiveReport, pose: Pose, settings: MavlinkSettings, time_us: int
) -> Any | Withheld:
    uncertainty = report.detection.uncertainty
    if report.detection.quality != "full" or uncertainty is None:
        return "no_attitude"
    fields = position_estimate_fields(
        pose, uncertainty.covariance, settings.mount, settings.heading_deg
    )
    return messages.position_estimate(fields, time_us)


def _local(body: Target, taken_ns: int | None, peer: Peer) -> Target | Withheld | None:
    found = "never" if taken_ns is None else peer.track.at(taken_ns * 1e-9)
    if isinstance(found, tuple):
        return body.moved(*found)
    return None if found == "not_yet" else "no_vehicle_pose"
