"""PX4's ULog, by `pyulog`.

References
----------
https://docs.px4.io/main/en/dev_log/ulog_file_format.html
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.media.telemetry.columns import TelemetryError
from padstudio.media.telemetry.vehicle_log import Series, VehicleLog

# A file that was cut is read short a few times, one that leads the reader back without end.
_MOST_SHORT_READS = 1000
_TOPICS = ["vehicle_attitude", "vehicle_local_position", "vehicle_global_position"]


def parse(data: bytes) -> VehicleLog:
    """Read a log's attitude, local and global position.

    Raises
    ------
    TelemetryError
        If it is damaged beyond reading.
    """
    from pyulog import ULog

    try:
        log = ULog(_Ending(data), _TOPICS)
        # The first of several sensors of a kind is the one that is flown by.
        topics = {each.name: each.data for each in log.data_list if each.multi_id == 0}
        return _log(topics)
    except TelemetryError:
        raise
    except Exception as error:
        # A damaged file may bring any error to light in the library.
        raise TelemetryError(f"the ULog file is damaged: {error}") from error


class _Ending(io.BytesIO):
    """Bytes that are not asked for beyond their end for ever, as the library does of cut files."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        self._short = 0

    def read(self, size: int | None = -1, /) -> bytes:
        """Raise `TelemetryError` where the end was met too often."""
        found = super().read(size)
        if size is not None and len(found) < size:
            self._short += 1
            if self._short > _MOST_SHORT_READS:
                raise TelemetryError("the ULog file is damaged: it ends within a message")
        return found


def _log(topics: dict[str, dict[str, Any]]) -> VehicleLog:
    attitude = _series(topics.get("vehicle_attitude"), [f"q[{k}]" for k in range(4)])
    local = _series(topics.get("vehicle_local_position"), ["x", "y", "z"], "xy_valid", "z_valid")
    height = _series(topics.get("vehicle_local_position"), ["z"], "z_valid")
    if height is not None:
        height = Series(height.time_s, -height.values)
    place = _series(topics.get("vehicle_global_position"), ["lat", "lon", "alt"])
    return VehicleLog("ulog", attitude, local, height, place)


def _series(topic: dict[str, Any] | None, names: list[str], *valid: str) -> Series | None:
    """Fields over time, s, where the flags that the topic has are set."""
    if topic is None or not all(name in topic for name in names):
        return None
    time_s: Array = np.asarray(topic["timestamp"], float) / 1e6
    good = np.ones(len(time_s), bool)
    for flag in valid:
        good &= np.asarray(topic[flag], bool) if flag in topic else True
    values = np.column_stack([np.asarray(topic[name], float) for name in names])
    return Series.of(time_s[good], values[good])
