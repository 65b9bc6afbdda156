"""Reads telemetry of any kind that is known, by its content."""

from __future__ import annotations

import codecs
from collections.abc import Callable
from typing import Any

from padstudio.media import content
from padstudio.media.content import ContentError
from padstudio.media.remote import read_bytes
from padstudio.media.telemetry import columns, srt
from padstudio.media.telemetry.columns import TelemetryError
from padstudio.media.telemetry.vehicle_log import VehicleLog

#: Bytes of a telemetry file; an hour of subtitles takes about 40 MB.
MAX_BYTES = 256_000_000


def read(source: str) -> dict[str, Any]:
    """Read a stored file.

    Parameters
    ----------
    source : str
        Path or URL.

    Returns
    -------
    dict
        As `padstudio.media.telemetry.columns.to_dict` or `VehicleLog.to_dict`.

    Raises
    ------
    TelemetryError
        If it is none, or holds neither height nor attitude nor position.
    """
    data = read_bytes(source, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise TelemetryError(f"the telemetry has more than {MAX_BYTES // 1_000_000} MB")
    return parse(data)


def parse(data: bytes) -> dict[str, Any]:
    """Read the content of a file; as `read`."""
    try:
        kind = content.identify(data[: content.HEAD_BYTES]).suffix
    except ContentError as error:
        raise TelemetryError(error.message) from error
    if kind in _LOGS:
        return _LOGS[kind](data).to_dict()
    return columns.to_dict(srt.parse_srt(_text(data)))


def _text(data: bytes) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16", "replace")
    return data.decode("utf-8-sig", "replace")


def _ulog(data: bytes) -> VehicleLog:
    from padstudio.media.telemetry import ulog

    return ulog.parse(data)


def _dataflash(data: bytes) -> VehicleLog:
    from padstudio.media.telemetry import dataflash

    return dataflash.parse(data)


def _tlog(data: bytes) -> VehicleLog:
    from padstudio.media.telemetry import tlog

    return tlog.parse(data)


def _table(data: bytes) -> VehicleLog:
    from padstudio.media.telemetry import vehicle_table

    return vehicle_table.parse(data)


_LOGS: dict[str, Callable[[bytes], VehicleLog]] = {
    content.ULOG.suffix: _ulog,
    content.DATAFLASH.suffix: _dataflash,
    content.TLOG.suffix: _tlog,
    content.VEHICLE_CSV.suffix: _table,
}
