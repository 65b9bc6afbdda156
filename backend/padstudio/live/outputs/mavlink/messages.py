"""MAVLink messages of what is known."""

from __future__ import annotations

from typing import Any

from pymavlink.dialects.v20 import common

from padstudio.autopilot.target import Sight, Target, picture_fields, position_fields
from padstudio.live.reports.report import Sight as SightState

_TEXT_BYTES = 50
_SAID = {"found": "Pad found", "lost": "Pad lost", "no_stream": "No frames from the camera"}
#: The frame of LANDING_TARGET that an autopilot takes.
FRAMES = {"ardupilot": common.MAV_FRAME_BODY_FRD, "px4": common.MAV_FRAME_LOCAL_NED}
#: Profiles by MAV_AUTOPILOT.
PROFILES = {
    common.MAV_AUTOPILOT_ARDUPILOTMEGA: "ardupilot",
    common.MAV_AUTOPILOT_PX4: "px4",
}


def heartbeat() -> Any:
    """Of an onboard controller that is no autopilot."""
    return common.MAVLink_heartbeat_message(
        common.MAV_TYPE_ONBOARD_CONTROLLER,
        common.MAV_AUTOPILOT_INVALID,
        0,
        0,
        common.MAV_STATE_ACTIVE,
        3,
    )


def landing_target(
    sight: Sight,
    body: Target,
    target: Target,
    *,
    time_us: int,
    frame: int,
    number: int,
    pad_size_mm: tuple[float, float] | None,
) -> Any:
    """LANDING_TARGET.

    Parameters
    ----------
    sight : Sight
    body, target : Target
        The pad in the body frame, and in that of the message.
    time_us : int
        When the frame was taken, on the autopilot's clock.
    frame : int
        MAV_FRAME of ``target``.
    number : int
    pad_size_mm : (width, height) or None
    """
    return common.MAVLink_landing_target_message(
        time_usec=time_us,
        target_num=number,
        frame=frame,
        **picture_fields(sight, body, pad_size_mm),
        **position_fields(target),
        type=common.LANDING_TARGET_TYPE_VISION_FIDUCIAL,
        position_valid=1,
    )


def position_estimate(fields: dict[str, Any], time_us: int) -> Any:
    """VISION_POSITION_ESTIMATE."""
    return common.MAVLink_vision_position_estimate_message(usec=time_us, **fields)


def sight_text(sight: SightState, detail: str) -> Any:
    """STATUSTEXT that the pad was lost or found; as much of why as it holds."""
    is_good = sight == "found"
    text = _SAID[sight] if is_good or not detail else f"{_SAID[sight]}: {detail}"
    return common.MAVLink_statustext_message(
        common.MAV_SEVERITY_INFO if is_good else common.MAV_SEVERITY_WARNING,
        text.encode("ascii", "replace")[:_TEXT_BYTES],
    )
