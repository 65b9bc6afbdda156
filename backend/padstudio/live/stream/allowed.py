"""Which sources a server may open: the hosts that its settings list, and no others.

A host that is listed is trusted: an RTSP camera may answer by a redirection, or name other hosts in
its description, which FFmpeg follows. HTTP is not followed elsewhere.
"""

from __future__ import annotations

import ipaddress
import re
import urllib.parse
from collections.abc import Sequence
from dataclasses import dataclass, field

from padstudio.errors import AccessError
from padstudio.live.stream.addresses import StreamAddress
from padstudio.network import ip_address, lookup, may_lead_to

_ENTRY = re.compile(
    r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9](?:[A-Za-z0-9.-]*[A-Za-z0-9])?)(?::(\d{1,5}))?"
)
_Network = ipaddress.IPv4Network | ipaddress.IPv6Network


@dataclass(frozen=True)
class AllowedSources:
    """What may be opened on behalf of others.

    Attributes
    ----------
    hosts : sequence of str
        ``host``: at any port; ``host:port``; a network such as ``192.168.1.0/24``, for addresses
        and for names that lead there. Names are compared as a whole; IPv6 addresses stand in
        brackets. To listen for UDP and RTP at a port, ``0.0.0.0:5600``.
    devices, files : bool
        Whether capture devices, and files of the server's own disk, may be opened.

    Raises
    ------
    ValueError
        If an entry is none of these.
    """

    hosts: Sequence[str] = ()
    devices: bool = False
    files: bool = False
    _names: frozenset[tuple[str, int | None]] = field(init=False, repr=False)
    _networks: tuple[_Network, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        names: set[tuple[str, int | None]] = set()
        networks: list[_Network] = []
        for entry in self.hosts:
            found = _ENTRY.fullmatch(entry)
            if "/" in entry:
                networks.append(ipaddress.ip_network(entry))
            elif found:
                port = int(found[2]) if found[2] else None
                names.add((found[1].strip("[]").lower(), port))
            else:
                raise ValueError(f"{entry!r} must be host, host:port or a network a.b.c.d/n")
        object.__setattr__(self, "_names", frozenset(names))
        object.__setattr__(self, "_networks", tuple(networks))

    def check(self, address: StreamAddress) -> StreamAddress:
        """The address as it may be opened: its host replaced by the IP address that was checked.

        Names are looked up here and never again, so that none leads elsewhere later; call this in
        a thread that may wait. Addresses of ``rtsps`` and ``https`` keep their names for the
        certificate's sake, and are allowed by their names alone.

        Raises
        ------
        AccessError
            Code ``source_refused``: the settings do not allow it.
        OSError
            If a name is not known.
        """
        if address.kind in ("device", "file", "sdp"):
            if self.devices if address.kind == "device" else self.files:
                return address
            what = "capture devices" if address.kind == "device" else "files of its own disk"
            raise _refused(f"this server opens no {what}; whoever runs it can allow them")
        host, port = address.host.lower(), address.port
        is_named = bool({(host, port), (host, None)} & self._names)
        if address.kind in ("udp", "rtp"):
            if is_named:
                return address
            raise _refused(
                f"this server does not listen at {host}:{port}; whoever runs it can list "
                f"{host}:{port} among the hosts of live sources"
            )
        for found in lookup(host, port) if is_named or self._networks else []:
            if (is_named and may_lead_to(host, found)) or self._is_in_networks(found):
                if not address.is_secure:
                    return _pinned(address, found)
                if is_named:
                    return address
        raise _refused(
            f"this server opens no streams of {host} on port {port}; whoever runs it can list the "
            "host among those of live sources"
        )

    def _is_in_networks(self, found: str) -> bool:
        address = ip_address(found)
        return any(address in network for network in self._networks)


def _pinned(address: StreamAddress, found: str) -> StreamAddress:
    parts = urllib.parse.urlsplit(address.url)
    user, at, _ = parts.netloc.rpartition("@")
    inside = f"[{found}]" if ":" in found else found
    url = parts._replace(netloc=f"{user}{at}{inside}:{address.port}").geturl()
    # What is shown, and what an HTTP server is asked for, stays the name.
    return StreamAddress(address.kind, url, address.shown, address.host, address.port)


def _refused(message: str) -> AccessError:
    return AccessError(message, code="source_refused")
