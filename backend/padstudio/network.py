"""Where names of hosts lead, and where none may lead."""

from __future__ import annotations

import ipaddress
import socket

IpAddress = ipaddress.IPv4Address | ipaddress.IPv6Address


def lookup(host: str, port: int) -> list[str]:
    """The IP addresses of a host, in the resolver's order; raises OSError where there is none."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(str(entry[4][0]) for entry in found))


def may_lead_to(host: str, address: str) -> bool:
    """Whether a name that a server's settings allow may lead to an address.

    Names lead to private and loopback addresses where an operator's own resolver says so, but never
    to link-local ones, where clouds keep their secrets, nor to groups of hosts.
    """
    return host == address or not _is_special(ip_address(address))


def ip_address(text: str) -> IpAddress:
    """An address without the zone that IPv6 may add; raises ValueError where it is none."""
    address = ipaddress.ip_address(text.partition("%")[0])
    if isinstance(address, ipaddress.IPv6Address) and address.ipv4_mapped:
        return address.ipv4_mapped
    return address


def _is_special(address: IpAddress) -> bool:
    return address.is_link_local or address.is_multicast or address.is_unspecified
