"""How a stream is opened and read, and what that is in FFmpeg's words.

References
----------
https://ffmpeg.org/ffmpeg-protocols.html and https://ffmpeg.org/ffmpeg-formats.html: options of
RTSP, RTP, UDP and HTTP; https://ffmpeg.org/ffmpeg-devices.html: of capture devices; RFC 8866 (SDP),
RFC 6184 and RFC 7798 (H.264 and H.265 in RTP).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from padstudio.live.stream.addresses import CAPTURES, RTP_CODECS, StreamAddress
from padstudio.media.video import MAX_PIXELS

Transport = Literal["tcp", "udp"]


@dataclass(frozen=True)
class StreamOptions:
    """How a stream is opened and read.

    Attributes
    ----------
    transport : {"tcp", "udp"}
        Of RTSP's pictures.
    silent_s : float
        A stream that sends nothing for so long is lost.
    connect_s : float
        For each of the two steps of opening: the connection, and what it carries.
    retry_s, most_retry_s : float
        Pause before a lost stream is tried again; it doubles from try to try, up to the second.
    attempts : int or None
        Tries in a row that may fail; None: it is tried for ever.
    late_s : float
        What waits for longer to be decoded is passed over where a keyframe waits behind it.
    stale_s : float
        What waits for longer is passed over up to the next keyframe that comes.
    verify_tls : bool
        Of ``rtsps`` and ``https``: the other side's certificate must be of an authority that this
        computer knows, and of that host.
    loop : bool
        A file begins again at its end.
    max_pixels : int
        Of a frame.
    size_px : (width, height) or None
        Of capture devices; None: what they give unasked.
    rate_hz : float or None
        Likewise, frames a second.
    """

    transport: Transport = "tcp"
    silent_s: float = 2.0
    connect_s: float = 2.4
    retry_s: float = 0.25
    most_retry_s: float = 4.0
    attempts: int | None = None
    late_s: float = 0.3
    stale_s: float = 2.0
    verify_tls: bool = True
    loop: bool = False
    max_pixels: int = MAX_PIXELS
    size_px: tuple[int, int] | None = None
    rate_hz: float | None = None

    def pause_s(self, failures: int) -> float:
        """The pause after so many failures in a row."""
        doubled = self.retry_s * 2.0 ** min(max(failures - 1, 0), 60)
        return min(self.most_retry_s, doubled)


@dataclass(frozen=True)
class Opening:
    """What FFmpeg is told.

    Attributes
    ----------
    target : str
        Address or device, unless ``sdp`` is given.
    form : str or None
        FFmpeg's name of the format; None: it finds out, among those that ``options`` allow.
    options : dict of str
    sdp : bytes or None
        A description to be read in place of an address.
    """

    target: str
    form: str | None
    options: dict[str, str]
    sdp: bytes | None = None


# What is looked at before the first frame: enough for a keyframe's parameters. Packets that were
# looked at are kept and decoded, as a stream that waits for its next keyframe loses more.
_LOOK = {"probesize": "1000000", "analyzeduration": "1000000", "fpsprobesize": "0"}
# Of UDP, bytes: a keyframe comes in a burst.
_SOCKET_BYTES = 2 << 20
# Packets of RTP that come too early wait for those before them no longer than this, µs.
_REORDER_US = "50000"
_HTTP_FORMS = "mpjpeg,mpegts,mjpeg"


def opening_of(address: StreamAddress, options: StreamOptions, sdp: bytes | None) -> Opening:
    """How FFmpeg is to open an address.

    Parameters
    ----------
    address : StreamAddress
    options : StreamOptions
    sdp : bytes or None
        What an SDP file holds.
    """
    common = _LOOK | {"max_pixels": str(options.max_pixels)}
    if address.kind == "rtsp":
        common |= {
            "protocol_whitelist": "rtsp,rtp,udp,tcp,tls",
            "rtsp_transport": options.transport,
        }
        common |= {"max_delay": _REORDER_US, "buffer_size": str(_SOCKET_BYTES)}
        common |= _secured(address, options) | {"allowed_media_types": "video"}
        return Opening(address.url, "rtsp", common)
    if address.kind == "udp":
        common |= {"protocol_whitelist": "udp", "buffer_size": str(_SOCKET_BYTES)}
        common |= {"fifo_size": "20000", "overrun_nonfatal": "1"} | _local(address)
        return Opening(address.url, "mpegts", common)
    if address.kind in ("rtp", "sdp"):
        common |= {"protocol_whitelist": "rtp,udp", "max_delay": _REORDER_US}
        common |= {"buffer_size": str(_SOCKET_BYTES)} | _local(address)
        told = sdp or _described(address)
        return Opening(address.url, "sdp" if told else "rtp", common, told)
    if address.kind == "http":
        common |= {"protocol_whitelist": "http,https,tls,tcp", "format_whitelist": _HTTP_FORMS}
        common |= {"max_redirects": "0", "http_proxy": "", "seekable": "0"}
        common |= {"headers": f"Host: {_authority(address)}\r\n", "strict_mime_boundary": "0"}
        return Opening(address.url, None, common | _secured(address, options))
    name, _, device = address.url.partition(":")
    if options.size_px is not None:
        common["video_size"] = "{}x{}".format(*options.size_px)
    if options.rate_hz is not None:
        common["framerate"] = f"{options.rate_hz:g}"
    target = f"video={device}" if name == "dshow" else device
    return Opening(target, CAPTURES[name], common | {"protocol_whitelist": ""})


def _secured(address: StreamAddress, options: StreamOptions) -> dict[str, str]:
    if not address.is_secure or not options.verify_tls:
        return {}
    import ssl

    # FFmpeg's own library does not know where this computer keeps its authorities.
    authorities = ssl.get_default_verify_paths().cafile
    return {"tls_verify": "1"} | ({"ca_file": authorities} if authorities else {})


def _local(address: StreamAddress) -> dict[str, str]:
    return {key: value for key, value in address.query if key == "localaddr"}


def _authority(address: StreamAddress) -> str:
    inside = f"[{address.host}]" if ":" in address.host else address.host
    usual = 443 if address.is_secure else 80
    return inside if address.port == usual else f"{inside}:{address.port}"


def _described(address: StreamAddress) -> bytes | None:
    """The SDP of RTP that an address tells the codec of; None where it does not."""
    values = dict(address.query)
    if "codec" not in values:
        return None
    payload, codec = values.get("payload", "96"), RTP_CODECS[values["codec"].lower()]
    family = "IP6" if ":" in address.host else "IP4"
    lines = ["v=0", f"o=- 0 0 IN {family} {address.host}", "s=live", "t=0 0"]
    lines += [f"c=IN {family} {address.host}", f"m=video {address.port} RTP/AVP {payload}"]
    lines += [f"a=rtpmap:{payload} {codec}/90000"]
    if codec == "H264":
        lines += [f"a=fmtp:{payload} packetization-mode=1"]
    return "".join(f"{line}\r\n" for line in lines).encode()
