"""Where the autopilot is: ``udpout:host:port`` and its kin."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal, cast

from padstudio.errors import SpecError

Kind = Literal["udpout", "udpin", "tcp", "serial"]
_NETWORK = re.compile(r"(udpout|udpin|tcp):(?:\[([^\[\]]+)\]|([^:\[\]]+)):(\d{1,5})")
_SERIAL = re.compile(r"serial:(.+):(\d{1,8})")


@dataclass(frozen=True)
class Address:
    """One end of a link.

    Attributes
    ----------
    kind : {"udpout", "udpin", "tcp", "serial"}
        Packets to an address; those of whoever sends to a port of ours; a connection to a server;
        a serial port.
    place : str
        A host, or a device.
    number : int
        A port, or a baud rate.
    """

    kind: Kind
    place: str
    number: int

    def __str__(self) -> str:
        place = f"[{self.place}]" if self.kind != "serial" and ":" in self.place else self.place
        return f"{self.kind}:{place}:{self.number}"


def parse_address(text: str) -> Address:
    """Read an address.

    Raises
    ------
    SpecError
        If it is none.
    """
    network, serial = _NETWORK.fullmatch(text), _SERIAL.fullmatch(text)
    if network is not None and 0 < int(network[4]) < 65536:
        return Address(cast("Kind", network[1]), network[2] or network[3], int(network[4]))
    if serial is not None and int(serial[2]) > 0:
        return Address("serial", serial[1], int(serial[2]))
    raise SpecError(
        f"{text!r} is no MAVLink address: give udpout:HOST:PORT (packets to there), "
        "udpin:HOST:PORT (packets that come to a port here, as udpin:0.0.0.0:14550), "
        "tcp:HOST:PORT or serial:DEVICE:BAUD",
        code="invalid_mavlink_address",
    )
