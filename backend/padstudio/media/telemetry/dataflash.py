"""ArduPilot's DataFlash log (``.bin``), by `pymavlink`.

References
----------
https://ardupilot.org/copter/docs/logmessages.html
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from padstudio.media.telemetry.columns import TelemetryError
from padstudio.media.telemetry.vehicle_log import Series, VehicleLog, columns_of, quaternion_wxyz

# Estimators by preference: local positions are those of one of them, throughout.
_ESTIMATORS = ("XKF1", "NKF1")
_FIELDS = {
    "ATT": ("Roll", "Pitch", "Yaw"),
    "POS": ("Lat", "Lng", "Alt", "RelHomeAlt"),
    "BARO": ("Alt",),
} | dict.fromkeys(_ESTIMATORS, ("PN", "PE", "PD"))
# Of several sensors or estimators the first.
_INSTANCES = {"BARO": "I"} | dict.fromkeys(_ESTIMATORS, "C")


def parse(data: bytes) -> VehicleLog:
    """Read a log's attitude, position and height.

    Height is over the home position, where there is none over the estimator's origin, and else the
    first barometer's.

    Raises
    ------
    TelemetryError
        If it is damaged beyond reading.
    """
    with tempfile.TemporaryDirectory() as folder:
        # The library reads files by their names alone.
        path = Path(folder) / "log.bin"
        path.write_bytes(data)
        try:
            with _unheard():
                rows = _rows(str(path))
        except Exception as error:
            # A damaged file may bring any error to light in the library.
            raise TelemetryError(f"the DataFlash log is damaged: {error}") from error
    return _log(rows)


@contextlib.contextmanager
def _unheard() -> Iterator[None]:
    """The library prints what it finds odd in a file; on standard output others expect results."""
    with (
        open(os.devnull, "w", encoding="utf-8") as nowhere,
        contextlib.redirect_stdout(nowhere),
        contextlib.redirect_stderr(nowhere),
    ):
        yield


def _rows(path: str) -> dict[str, list[list[float]]]:
    """Time, s, and fields of each message of a kind."""
    from pymavlink.DFReader import DFReader_binary

    class Advancing(DFReader_binary):  # type: ignore[misc]
        """A reader that a message without a length does not keep at its place for ever."""

        def _parse_next(self) -> Any:
            before = self.offset
            found = super()._parse_next()
            if found is not None and self.offset <= before:
                raise ValueError("a message has no length")
            return found

    rows: dict[str, list[list[float]]] = defaultdict(list)
    # Made in two steps, as one that a damaged file brings down would leave the file open.
    reader: Any = Advancing.__new__(Advancing)
    try:
        reader.__init__(path)
        while (message := reader.recv_match(type=list(_FIELDS))) is not None:
            kind = message.get_type()
            if getattr(message, _INSTANCES.get(kind, ""), 0) == 0:
                values = _values(message, _FIELDS[kind])
                if values is not None:
                    rows[kind].append(values)
    finally:
        for held in ("filehandle", "data_map"):
            # An error that is on its way may still look into the map, which goes with it then.
            with contextlib.suppress(BufferError, AttributeError):
                getattr(reader, held).close()
    return rows


def _values(message: Any, fields: tuple[str, ...]) -> list[float] | None:
    """None of a message without a time or one of the fields, as of very old programs."""
    try:
        return [message.TimeUS / 1e6, *(float(getattr(message, name)) for name in fields)]
    except AttributeError:
        return None


def _log(rows: dict[str, list[list[float]]]) -> VehicleLog:
    tables = {kind: columns_of(rows[kind], 1 + len(names)) for kind, names in _FIELDS.items()}
    att, pos, baro = (tables[kind] for kind in ("ATT", "POS", "BARO"))
    ekf = next((tables[kind] for kind in _ESTIMATORS if len(tables[kind])), tables["XKF1"])
    heights = [
        Series.of(pos[:, 0], pos[:, 4]),
        Series.of(ekf[:, 0], -ekf[:, 3]),
        Series.of(baro[:, 0], baro[:, 1]),
    ]
    return VehicleLog(
        "dataflash",
        attitude=Series.of(att[:, 0], quaternion_wxyz(*np.radians(att[:, 1:].T))),
        local=Series.of(ekf[:, 0], ekf[:, 1:]),
        height=next((series for series in heights if series is not None), None),
        place=Series.of(pos[:, 0], pos[:, 1:4]),
    )
