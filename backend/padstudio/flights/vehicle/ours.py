"""The poses of a flight that its vehicle's log is compared with."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import func, select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.arrays import Array
from padstudio.store.database.flight_tables import FlightRow, FrameDetailRow, FrameRow

# A flight of more frames is thinned evenly: motion is slow against ten a second.
_MOST = 12_000


@dataclass(frozen=True, eq=False)
class OurPoses:
    """Poses that are not of quality ``bearing``, in the order of time.

    Attributes
    ----------
    frame : (N,) int64
    time_s : (N,) float64
    height_m : (N,) float64
        Of the camera over the pad.
    quaternion_wxyz : (N, 4) float64
        Scalar first, takes camera vectors to pad vectors.
    """

    frame: NDArray[np.int64]
    time_s: Array
    height_m: Array
    quaternion_wxyz: Array


def poses_of(sessions: sessionmaker[Session], flight: FlightRow) -> OurPoses:
    """Read them; of a flight with several pads those of the pad that has most.

    Parameters
    ----------
    sessions : sessionmaker
    flight : FlightRow
    """
    wanted = (
        FrameRow.flight == flight.key,
        FrameRow.status == "ok",
        FrameRow.time_s.is_not(None),
        FrameRow.quality.is_distinct_from("bearing"),
    )
    with sessions() as session:
        count = session.scalar(select(func.count()).select_from(FrameRow).where(*wanted)) or 0
        every = max(1, -(-count // _MOST)) * int(flight.request.get("stride", 1))
        first = session.scalar(select(func.min(FrameRow.number)).where(*wanted)) or 0
        rows = session.execute(
            select(FrameRow.number, FrameRow.time_s, FrameRow.z_mm, FrameDetailRow.body)
            .join(
                FrameDetailRow,
                (FrameDetailRow.flight == FrameRow.flight)
                & (FrameDetailRow.number == FrameRow.number),
            )
            .where(*wanted, (FrameRow.number - first) % every == 0)
            .order_by(FrameRow.number)
        ).all()
    pads = Counter(body.get("pad_id") for *_, body in rows)
    most = pads.most_common(1)[0][0] if pads else None
    kept = [row for row in rows if row[3].get("pad_id") == most]
    turns = np.array([row[3]["quaternion_xyzw"] for row in kept], float).reshape(-1, 4)
    return OurPoses(
        np.array([row[0] for row in kept], np.int64),
        np.array([row[1] for row in kept], float),
        np.array([row[2] for row in kept], float) / 1000,
        turns[:, [3, 0, 1, 2]],
    )
