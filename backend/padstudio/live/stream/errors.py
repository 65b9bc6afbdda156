"""What is wrong with a stream, by name; FFmpeg's own messages hold addresses with passwords."""

from __future__ import annotations

import errno
import socket

from padstudio.errors import StudioError
from padstudio.live.stream.addresses import StreamAddress


class StreamError(StudioError):
    """A stream cannot be opened or read.

    Parameters
    ----------
    message, code
        As of `StudioError`.
    is_final : bool
        Trying again makes no sense.
    """

    code = "stream_failed"
    status = 422

    def __init__(self, message: str, *, code: str, is_final: bool = False) -> None:
        super().__init__(message, code=code)
        self.is_final = is_final


# Codes and sentences by the system's number of an error; whether trying again is no use.
_BY_NUMBER: dict[int, tuple[str, str, bool]] = {
    errno.EIO: ("connection_lost", "the connection broke, or never stood", False),
    errno.ECONNREFUSED: (
        "connection_refused",
        "nothing answers at this address and port; is the camera on, is its stream started?",
        False,
    ),
    errno.ECONNRESET: ("connection_lost", "the connection was cut by the other side", False),
    errno.EPIPE: ("connection_lost", "the connection was cut by the other side", False),
    errno.EADDRINUSE: (
        "port_taken",
        "another program listens at this port already; end it, or choose another port",
        False,
    ),
    errno.EADDRNOTAVAIL: (
        "no_such_interface",
        "this computer has no such address to listen at; 0.0.0.0 listens at all of its own",
        False,
    ),
    errno.EBUSY: ("device_busy", "another program uses the device; close it there", False),
    errno.EACCES: (
        "permission",
        "this user may not open it; on Linux, cameras belong to the group video",
        True,
    ),
    errno.EPERM: ("permission", "this user may not open it", True),
    errno.ENOTTY: ("no_camera_device", "this is no camera", True),
}
_ABSENT = (errno.ENOENT, errno.ENODEV, errno.ENXIO)
_UNREACHABLE = (errno.ENETUNREACH, errno.EHOSTUNREACH, errno.ENETDOWN, errno.EHOSTDOWN)
# FFmpeg tells these by classes.
_BY_CLASS: dict[str, tuple[str, str, bool]] = {
    "HTTPUnauthorizedError": (
        "unauthorized",
        "the camera asks for a user name and a password, or does not take these; give them as "
        "scheme://user:password@host",
        True,
    ),
    "HTTPForbiddenError": ("unauthorized", "the camera refuses to show its stream", True),
    "HTTPNotFoundError": (
        "stream_not_found",
        "the camera answers but has no stream of this name; look the path up in its manual",
        False,
    ),
    "InvalidDataError": (
        "not_a_stream",
        "what comes from there is no video stream of the kind that the address names",
        False,
    ),
    "ExitError": ("no_answer", "no answer in time; check address, port and network", False),
    "TimeoutError": ("no_answer", "no answer in time; check address, port and network", False),
    "DecoderNotFoundError": ("unsupported_codec", "its codec cannot be decoded", True),
    "PatchWelcomeError": ("unsupported_codec", "its format is not supported by FFmpeg", True),
}


def explain(error: Exception, address: StreamAddress) -> StreamError:
    """The error of FFmpeg or of the system by name, without any password."""
    if isinstance(error, StreamError):
        return error
    code, sentence, is_final = _told(error, address)
    return StreamError(f"{address.shown}: {sentence}", code=code, is_final=is_final)


def _told(error: Exception, address: StreamAddress) -> tuple[str, str, bool]:
    if isinstance(error, StudioError):
        return error.error_code, error.message, True
    if isinstance(error, socket.gaierror):
        return "unknown_host", f"no address is known for the host {address.host}", False
    number = error.errno if isinstance(error, OSError) else None
    if number == errno.EIO and address.kind == "http":
        return (
            "not_a_stream",
            "no video comes from there, or no more: it is a page, or leads elsewhere; give the "
            "stream's own address",
            False,
        )
    if type(error).__name__ == "ExitError" and address.kind in ("udp", "rtp", "sdp"):
        return "silent", "nothing comes in; does the sender send to this port of this host?", False
    if number in _UNREACHABLE:
        return "unreachable", "there is no way to this host from here; check the network", False
    if number in _ABSENT:
        if address.kind == "device":
            return "device_absent", "there is no such device; is it plugged in?", False
        return "stream_not_found", "there is no such file", True
    told = _BY_CLASS.get(type(error).__name__) or _BY_NUMBER.get(number or 0)
    return told or ("stream_failed", f"it cannot be read ({type(error).__name__})", False)
