"""Which addresses a server may call: the hosts that its settings list, and no others."""

from __future__ import annotations

import re
from collections.abc import Sequence

import httpx

from padstudio.errors import SpecError, StudioError
from padstudio.network import lookup, may_lead_to

#: Of an address, characters.
MAX_URL = 2000

# Names beyond ASCII are listed as DNS has them, `xn--…`.
_ENTRY = re.compile(
    r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9](?:[A-Za-z0-9.-]*[A-Za-z0-9])?)(?::(\d{1,5}))?"
)
_PORTS = {"http": 80, "https": 443}
# Printable ASCII: nothing that two readers of an address could take differently.
_PLAIN = re.compile(r"[!-~]+")


class CallbackError(StudioError):
    """A host cannot or must not be called; raised where it is called."""

    code = "callback_failed"


class CallbackHosts:
    """The hosts that may be called.

    Parameters
    ----------
    entries : sequence of str
        ``host``: on the usual port of ``https`` or ``http``; ``host:port``: on that port alone.
        Names and addresses are compared as a whole; IPv6 addresses stand in brackets.

    Raises
    ------
    ValueError
        If an entry is neither.
    """

    def __init__(self, entries: Sequence[str]) -> None:
        self._allowed: set[tuple[str, int | None]] = set()
        for entry in entries:
            parts = _ENTRY.fullmatch(entry)
            url = _parsed(f"https://{parts[1]}") if parts else None
            if parts is None or url is None:
                raise ValueError(f"{entry!r} must be host or host:port, without anything else")
            self._allowed.add((host_of(url), int(parts[2]) if parts[2] else None))

    def __bool__(self) -> bool:
        return bool(self._allowed)

    def check(self, text: str) -> httpx.URL:
        """The address as it is called.

        Raises
        ------
        SpecError
            If it is none that may be called; code ``callback_refused``.
        """
        url = _parsed(text)
        if url is None:
            raise _refused(
                "callback must be an address https://host/path or http://host/path, without user "
                f"name, password or fragment, of at most {MAX_URL} printable characters"
            )
        port = port_of(url)
        usual = port == _PORTS[url.scheme]
        host = host_of(url)
        if (host, port) in self._allowed or (usual and (host, None) in self._allowed):
            return url
        raise _refused(
            f"this server does not call {host} on port {port}; whoever runs it can list the "
            "host in PADSTUDIO_CALLBACK_HOSTS"
        )


def host_of(url: httpx.URL) -> str:
    """The host of an address, as DNS has it."""
    return url.raw_host.decode("ascii")


def port_of(url: httpx.URL) -> int:
    """The port of an address, said or usual."""
    return url.port or _PORTS[url.scheme]


def resolve(host: str, port: int) -> str:
    """The IP address that a host is called at.

    Raises
    ------
    CallbackError
        If it has no address, or none that may be called.
    """
    try:
        addresses = lookup(host, port)
    except OSError as error:
        raise CallbackError(f"{host} has no address: {error.strerror or error}") from error
    for address in addresses:
        if may_lead_to(host, address):
            return address
    raise CallbackError(f"{host} leads to {addresses[0]}, which no name may lead to")


def _parsed(text: str) -> httpx.URL | None:
    """An address in its parts, read by what calls it; None where it is not to be called."""
    if len(text) > MAX_URL or not _PLAIN.fullmatch(text) or "\\" in text:
        return None
    try:
        url = httpx.URL(text)
    except httpx.InvalidURL:
        return None
    plain = url.scheme in _PORTS and url.host and not url.userinfo and not url.fragment
    return url if plain and "#" not in text else None


def _refused(message: str) -> SpecError:
    return SpecError(message, code="callback_refused")
