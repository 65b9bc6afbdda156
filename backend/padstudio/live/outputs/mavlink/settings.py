"""What somebody chooses who sends poses to an autopilot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from padstudio.autopilot.vehicle import DOWNWARD, Mount
from padstudio.errors import SpecError
from padstudio.live.outputs.mavlink.address import Address

#: Which autopilot's way of LANDING_TARGET; ``auto`` by the heartbeat that is heard.
Profile = Literal["auto", "ardupilot", "px4"]
#: What is sent of a pose.
Message = Literal["landing_target", "position_estimate"]

#: The component id of a companion computer (MAV_COMP_ID_ONBOARD_COMPUTER).
ONBOARD_COMPUTER = 191
_KEY_BYTES = 32


@dataclass(frozen=True, kw_only=True)
class MavlinkSettings:
    """How poses go to an autopilot.

    Attributes
    ----------
    address : Address
    profile : {"auto", "ardupilot", "px4"}
    message : {"landing_target", "position_estimate"}
        LANDING_TARGET, or VISION_POSITION_ESTIMATE for autopilots that do not take it.
    mount : Mount
        How the camera sits on the vehicle.
    pad_size_mm : (width, height) or None
        Of the pad without its quiet margin.
    heading_deg : float
        Of up on the page, clockwise from north; for position estimates alone.
    system_id : int or None
        Of the vehicle; None for that of the autopilot that is heard.
    component_id : int
        Ours.
    target_number : int
        ``target_num`` of LANDING_TARGET.
    max_hz : float
        At most so many poses a second.
    max_age_s : float
        A frame that was taken longer ago is not sent any more. ArduPilot can account for 0.25 s.
    signing_key : bytes or None
        Thirty-two bytes; with it messages are signed, and others taken only with a right signature.

    Raises
    ------
    SpecError
        If a figure is out of range.
    """

    address: Address
    profile: Profile = "auto"
    message: Message = "landing_target"
    mount: Mount = DOWNWARD
    pad_size_mm: tuple[float, float] | None = None
    heading_deg: float = 0.0
    system_id: int | None = None
    component_id: int = ONBOARD_COMPUTER
    target_number: int = 0
    max_hz: float = 30.0
    max_age_s: float = 0.25
    signing_key: bytes | None = None

    def __post_init__(self) -> None:
        ids = (self.component_id, 1 if self.system_id is None else self.system_id)
        fits = (
            all(1 <= number <= 255 for number in ids)
            and 0 <= self.target_number <= 255
            and 0 < self.max_hz <= 1000
            and 0 < self.max_age_s <= 10
            and abs(self.heading_deg) <= 360
            and (self.signing_key is None or len(self.signing_key) == _KEY_BYTES)
        )
        if not fits:
            raise SpecError(
                "MAVLink ids are 1 to 255, a target's number is 0 to 255, the rate is up to 1000 a "
                "second, the age up to 10 s, a signing key has 32 bytes",
                code="invalid_mavlink_settings",
            )


def read_signing_key(path: Path) -> bytes:
    """The key of a file: 32 bytes, or 64 hexadecimal digits.

    Raises
    ------
    SpecError
        If it holds neither. The content is never told.
    """
    data = path.read_bytes()
    if len(data) == _KEY_BYTES:
        return data
    try:
        key = bytes.fromhex(data.decode("ascii").strip())
    except ValueError:
        key = b""
    if len(key) == _KEY_BYTES:
        return key
    raise SpecError(
        f"{path} holds no signing key: give 32 bytes, or 64 hexadecimal digits, as the ground "
        "station has set it on the autopilot",
        code="invalid_signing_key",
    )
