"""Addresses of sources: which kinds there are, checked and without their passwords.

References
----------
RFC 3986 (addresses), RFC 7826 and RFC 2326 (RTSP), RFC 3551 (payload types of RTP).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal
from urllib.parse import SplitResult, parse_qsl, urlsplit

from padstudio.errors import SpecError

#: What is behind an address: RTSP; MPEG-TS or RTP that comes in over UDP; an SDP file that tells of
#: RTP; HTTP; a capture device; a video file.
Kind = Literal["rtsp", "udp", "rtp", "sdp", "http", "device", "file"]
#: Of an address, characters.
MAX_ADDRESS = 2000
#: FFmpeg's names of programs that capture, by what stands before a device's name.
CAPTURES = {"v4l2": "v4l2", "avfoundation": "avfoundation", "dshow": "dshow"}

_SCHEMES: dict[str, tuple[Kind, int]] = {
    "rtsp": ("rtsp", 554),
    "rtsps": ("rtsp", 322),
    "udp": ("udp", 0),
    "rtp": ("rtp", 0),
    "http": ("http", 80),
    "https": ("http", 443),
}
_KINDS = (
    "rtsp://, rtsps://, udp://, rtp://, http://, https://, an .sdp file, a video file, or a device "
    "such as /dev/video0, v4l2:/dev/video0, avfoundation:NAME or dshow:NAME"
)
# Nothing that two readers of an address could take differently.
_PLAIN = re.compile(r"[!-~]+")
_CAPTURE = re.compile(rf"({'|'.join(CAPTURES)}):(.+)", re.DOTALL)
_OTHER_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")
# What UDP and RTP addresses may say behind a question mark.
_QUERIES: dict[str, tuple[str, ...]] = {
    "udp": ("localaddr",),
    "rtp": ("codec", "payload", "localaddr"),
}
# Some cameras take the password within the path; of queries, only small numbers are no secrets.
_SECRET = re.compile(r"((?:pass|pwd|token|key|secret|auth)\w*=)[^&;/?]*", re.IGNORECASE)
_VALUE = re.compile(r"([^&;=]+=)(?!\d{0,3}(?:[&;]|$))[^&;]*")
#: Codecs that RTP can be told by address to carry, with their names in SDP.
RTP_CODECS = {"h264": "H264", "h265": "H265", "hevc": "H265"}


@dataclass(frozen=True)
class StreamAddress:
    """Where a stream is.

    Attributes
    ----------
    kind : Kind
    url : str
        As FFmpeg takes it, passwords included: never to be shown.
    shown : str
        The same with the password replaced.
    host : str
        Empty for devices and files. For UDP and RTP, what is listened at: an own address, a group,
        or 0.0.0.0.
    port : int
    query : tuple of (str, str)
        Of UDP and RTP addresses.
    """

    kind: Kind
    url: str = field(repr=False)
    shown: str
    host: str = ""
    port: int = 0
    query: tuple[tuple[str, str], ...] = ()

    @property
    def is_secure(self) -> bool:
        """Whether the other side has to show a certificate."""
        return self.url.lower().startswith(("rtsps:", "https:"))


def parse_address(text: str) -> StreamAddress:
    """An address by its parts.

    Raises
    ------
    SpecError
        Code ``bad_address``: it is ill-formed, or of a kind that is not known.
    """
    if not text or len(text) > MAX_ADDRESS or not text.isprintable():
        raise _refused(f"a source is one of {_KINDS}, of at most {MAX_ADDRESS} characters")
    if "://" in text:
        return _network(text)
    capture = _CAPTURE.fullmatch(text)
    if capture:
        return StreamAddress("device", text, text)
    if re.fullmatch(r"/dev/[\w/.:-]+", text):
        return StreamAddress("device", f"v4l2:{text}", text)
    # A letter and a colon are a drive of Windows.
    if _OTHER_SCHEME.match(text):
        raise _refused(f"the source's scheme is not known; a source is {_KINDS}")
    kind: Kind = "sdp" if Path(text).suffix.lower() == ".sdp" else "file"
    return StreamAddress(kind, text, text)


def _network(text: str) -> StreamAddress:
    scheme = text.partition("://")[0].lower()
    if scheme not in _SCHEMES:
        raise _refused(f"the source's scheme is not known; a source is {_KINDS}")
    kind, usual = _SCHEMES[scheme]
    if not _PLAIN.fullmatch(text) or "\\" in text or "#" in text:
        raise _refused("an address holds printable ASCII, no backslash and no #: write %5C or %23")
    try:
        parts = urlsplit(text)
        port = parts.port
    except ValueError:
        raise _refused("the address has no readable host or port") from None
    if kind in ("udp", "rtp"):
        return _listening(kind, parts, port)
    if not parts.hostname:
        raise _refused(f"the address has no host: write {scheme}://host/path")
    return StreamAddress(kind, text, _without_password(parts), parts.hostname, port or usual)


def _listening(kind: Kind, parts: SplitResult, port: int | None) -> StreamAddress:
    """An address at which packets come in; players write ``udp://@:5600`` or ``udp://:5600``."""
    if not port or parts.password or parts.path.strip("/"):
        raise _refused(
            f"write {kind}://0.0.0.0:PORT to listen at all addresses of this computer, or "
            f"{kind}://GROUP:PORT for a multicast group"
        )
    try:
        query = tuple(parse_qsl(parts.query, strict_parsing=True)) if parts.query else ()
    except ValueError:
        query = (("", ""),)
    known = _QUERIES[kind]
    if any(key not in known or not re.fullmatch(r"[\w.:]+", value) for key, value in query):
        raise _refused(f"behind the question mark, {kind}:// takes {', '.join(known)} alone")
    values = dict(query)
    if values.get("codec", "h264").lower() not in RTP_CODECS:
        raise _refused(f"codec is one of {', '.join(RTP_CODECS)}; others need an .sdp file")
    payload = values.get("payload", "96")
    if not re.fullmatch(r"[0-9]{1,3}", payload) or int(payload) > 127:
        raise _refused("payload is RTP's number of the payload's type, 0 … 127")
    host = parts.hostname or "0.0.0.0"
    inside = f"[{host}]" if ":" in host else host
    shown = f"{kind}://{inside}:{port}" + (f"?{parts.query}" if parts.query else "")
    return StreamAddress(kind, f"{kind}://{inside}:{port}", shown, host, port, query)


def _without_password(parts: SplitResult) -> str:
    """The address with whatever may be a secret replaced: the password, and values of queries."""
    user, _, place = parts.netloc.rpartition("@")
    if user:
        name, colon, _ = user.partition(":")
        place = f"{name}{':***' if colon else ''}@{place}"
    path = _SECRET.sub(r"\1***", parts.path)
    query = _VALUE.sub(r"\1***", parts.query)
    return parts._replace(netloc=place, path=path, query=query).geturl()


def _refused(message: str) -> SpecError:
    return SpecError(message, code="bad_address")
