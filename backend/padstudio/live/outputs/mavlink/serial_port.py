"""Serial ports by the system's own terminal interface (POSIX)."""

from __future__ import annotations

import errno
import os
import struct
import sys

from padstudio.errors import StudioError


class SerialPortError(StudioError):
    """A serial port cannot be used."""

    code = "serial_port_failed"
    status = 502


def open_serial(device: str, baud: int) -> int:
    """Open a port for eight bits, no parity, one stop bit, raw; gives its file descriptor.

    Raises
    ------
    SerialPortError
        If it is missing, another program's, not to be opened by this user, or no serial port; or
        the system does not know the baud rate.
    """
    if sys.platform == "win32":
        raise SerialPortError("serial ports need Linux or macOS; use udpin: or tcp: here")
    try:
        descriptor = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        raise _named(device, error) from error
    try:
        _claim(descriptor, device)
        _set_up(descriptor, device, baud)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def queued_bytes(descriptor: int) -> int:
    """What was written to a port or a connection and has still to go out; 0 where unknown."""
    try:
        import fcntl
        import termios

        return int(struct.unpack("i", fcntl.ioctl(descriptor, termios.TIOCOUTQ, b"\0" * 4))[0])
    except (ImportError, OSError):
        return 0


def _claim(descriptor: int, device: str) -> None:
    """Keep others out, those who ask by a lock and those who open it."""
    import fcntl
    import termios

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        fcntl.ioctl(descriptor, termios.TIOCEXCL)
    except BlockingIOError as error:
        raise _named(device, OSError(errno.EBUSY, "")) from error
    except OSError as error:
        raise _named(device, error) from error


def _set_up(descriptor: int, device: str, baud: int) -> None:
    import termios

    speed = getattr(termios, f"B{baud}", None)
    if speed is None:
        known = sorted(
            int(name[1:]) for name in dir(termios) if name[:1] == "B" and name[1:].isdigit()
        )
        raise SerialPortError(
            f"{device}: a baud rate of {baud} is not known here; known are "
            + ", ".join(map(str, (rate for rate in known if rate >= 9600))),
            code="serial_baud_unknown",
        )
    try:
        mode = termios.tcgetattr(descriptor)
        mode[0] = mode[1] = mode[3] = 0
        mode[2] = termios.CS8 | termios.CREAD | termios.CLOCAL
        mode[4] = mode[5] = speed
        mode[6][termios.VMIN] = mode[6][termios.VTIME] = 0
        termios.tcsetattr(descriptor, termios.TCSANOW, mode)
        termios.tcflush(descriptor, termios.TCIOFLUSH)
    except termios.error as error:
        raise _named(device, OSError(errno.ENOTTY, "")) from error


def _named(device: str, error: OSError) -> SerialPortError:
    if error.errno == errno.EBUSY:
        return SerialPortError(
            f"serial port {device} is busy: another program has it open; end that first",
            code="serial_port_busy",
        )
    if error.errno in (errno.EACCES, errno.EPERM):
        return SerialPortError(
            f"serial port {device} is not open to this user: join the group that owns it "
            "(dialout on Debian and Ubuntu), and log in again",
            code="serial_port_denied",
        )
    if error.errno in (errno.ENOENT, errno.ENXIO, errno.ENODEV):
        return SerialPortError(
            f"serial port {device} is not there: plug it in, or give another device",
            code="serial_port_missing",
        )
    if error.errno == errno.ENOTTY:
        return SerialPortError(
            f"{device} is no serial port: give its device, as serial:/dev/ttyUSB0:57600"
        )
    return SerialPortError(f"serial port {device}: {error.strerror or error}")
