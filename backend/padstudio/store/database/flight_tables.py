"""The tables of flights, their work and their results."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    String,
    Text,
    text,
)
from sqlalchemy.orm import Mapped, mapped_column

from padstudio.store.database.tables import Base, UtcDateTime

# SQLite counts up only what is plainly INTEGER.
_Key = BigInteger().with_variant(Integer, "sqlite")


class FlightRow(Base):
    """An analysis: what to do, and how far it is.

    Pad and camera are copies, so that it can be run again whatever becomes of theirs.
    """

    __tablename__ = "flights"

    key: Mapped[int] = mapped_column(_Key, primary_key=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, index=True)
    started_at: Mapped[datetime | None] = mapped_column(UtcDateTime)
    finished_at: Mapped[datetime | None] = mapped_column(UtcDateTime)
    name: Mapped[str] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(20), index=True)
    #: How the work is done: ids and names of pad and camera, method, parameters, range, stride.
    request: Mapped[dict[str, Any]] = mapped_column(JSON)
    #: What was found out of the uploads when the work was planned.
    sources: Mapped[list[dict[str, Any]]] = mapped_column(JSON)
    frames_total: Mapped[int | None] = mapped_column(Integer)
    frames_done: Mapped[int] = mapped_column(Integer, default=0)
    frames_ok: Mapped[int] = mapped_column(Integer, default=0)
    error: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    #: The flight that this one runs again with other parameters.
    rerun_of: Mapped[str | None] = mapped_column(String(32), index=True)
    #: What it was ordered under, so that it is not ordered twice.
    order_key: Mapped[str | None] = mapped_column(String(64), index=True, unique=True)
    pad: Mapped[str] = mapped_column(Text, deferred=True)
    #: The content of more pad files; None in flights of older programs.
    other_pads: Mapped[list[str] | None] = mapped_column(JSON, deferred=True)
    camera: Mapped[str] = mapped_column(Text, deferred=True)
    telemetry: Mapped[dict[str, Any] | None] = mapped_column(JSON, deferred=True)


class FlightUploadRow(Base):
    """Which uploads a flight reads; they cannot be removed before it."""

    __tablename__ = "flight_uploads"

    flight: Mapped[int] = mapped_column(
        BigInteger, ForeignKey("flights.key", ondelete="CASCADE"), primary_key=True
    )
    place: Mapped[int] = mapped_column(Integer, primary_key=True)
    upload: Mapped[str] = mapped_column(String(32), ForeignKey("uploads.id"), index=True)


class ChunkRow(Base):
    """A part of a flight that one task works on; number 0 plans the others."""

    __tablename__ = "chunks"
    __table_args__ = (
        Index("ix_chunks_flight_number", "flight", "number", unique=True),
        Index("ix_chunks_state_flight", "state", "flight", "number"),
    )

    id: Mapped[int] = mapped_column(_Key, primary_key=True)
    flight: Mapped[int] = mapped_column(BigInteger, ForeignKey("flights.key", ondelete="CASCADE"))
    number: Mapped[int] = mapped_column(Integer)
    state: Mapped[str] = mapped_column(String(20))
    #: Raised with every claim; only the claimant of the last one may finish the chunk.
    attempt: Mapped[int] = mapped_column(Integer, default=0)
    #: Attempts that ended in a dead or hanging worker.
    failures: Mapped[int] = mapped_column(Integer, default=0)
    #: For who looks; the server itself goes by a clock that nobody sets.
    lease_until: Mapped[datetime | None] = mapped_column(UtcDateTime)
    source: Mapped[int] = mapped_column(Integer, default=0)
    first_frame: Mapped[int] = mapped_column(Integer, default=0)
    #: Frames worked on: numbers ``first_frame``, ``first_frame + stride``, …
    frames: Mapped[int] = mapped_column(Integer, default=0)
    #: Their numbers, int64 little-endian, where they do not follow each other so.
    numbers: Mapped[bytes] = mapped_column(LargeBinary, server_default=text("''"), deferred=True)
    #: Their presentation timestamps, int64 little-endian; empty for stills.
    pts: Mapped[bytes] = mapped_column(LargeBinary, default=b"", deferred=True)
    error: Mapped[dict[str, Any] | None] = mapped_column(JSON)


class CallbackRow(Base):
    """Who is called when a flight has ended, and how that went; at most one a flight."""

    __tablename__ = "callbacks"

    flight: Mapped[int] = mapped_column(
        BigInteger, ForeignKey("flights.key", ondelete="CASCADE"), primary_key=True
    )
    #: Another one for each end of the flight; the same in all attempts to tell that end.
    delivery: Mapped[str] = mapped_column(String(32))
    url: Mapped[str] = mapped_column(Text)
    #: ``open``, ``delivered`` or ``given_up``.
    state: Mapped[str] = mapped_column(String(20), index=True)
    attempts: Mapped[int] = mapped_column(Integer)
    #: When it is tried again; None before the first attempt.
    next_at: Mapped[datetime | None] = mapped_column(UtcDateTime)
    delivered_at: Mapped[datetime | None] = mapped_column(UtcDateTime)
    #: Why the last attempt failed, a sentence.
    error: Mapped[str | None] = mapped_column(Text)


class FrameRow(Base):
    """What lists and charts need of a frame; rows are short, so that reading many is quick."""

    __tablename__ = "frames"
    __table_args__ = (
        Index("ix_frames_status", "flight", "status", "number"),
        Index("ix_frames_reason", "flight", "reason", "number"),
        Index("ix_frames_time_s", "flight", "time_s", "number"),
        {"sqlite_with_rowid": False},
    )

    flight: Mapped[int] = mapped_column(
        BigInteger, ForeignKey("flights.key", ondelete="CASCADE"), primary_key=True
    )
    number: Mapped[int] = mapped_column(Integer, primary_key=True)
    time_s: Mapped[float | None]
    status: Mapped[str] = mapped_column(String(10))
    stage: Mapped[str | None] = mapped_column(String(20))
    reason: Mapped[str | None] = mapped_column(String(40))
    layer: Mapped[str | None] = mapped_column(String(10))
    #: ``full`` or ``bearing``; None without a pose, and where it is not known.
    quality: Mapped[str | None] = mapped_column(String(10))
    x_mm: Mapped[float | None]
    y_mm: Mapped[float | None]
    #: Height over the pad.
    z_mm: Mapped[float | None]


class FrameDetailRow(Base):
    """The rest of a frame's result, for who looks at it."""

    __tablename__ = "frame_details"
    __table_args__ = ({"sqlite_with_rowid": False},)

    flight: Mapped[int] = mapped_column(
        BigInteger, ForeignKey("flights.key", ondelete="CASCADE"), primary_key=True
    )
    number: Mapped[int] = mapped_column(Integer, primary_key=True)
    chunk: Mapped[int] = mapped_column(Integer)
    #: A line of a poses file without what `FrameRow` has, and the covariance.
    body: Mapped[dict[str, Any]] = mapped_column(JSON)


class FrameBinRow(Base):
    """Up to a hundred frames in a row, summed up; see `padstudio.flights.results.bins`."""

    __tablename__ = "frame_bins"
    __table_args__ = ({"sqlite_with_rowid": False},)

    flight: Mapped[int] = mapped_column(
        BigInteger, ForeignKey("flights.key", ondelete="CASCADE"), primary_key=True
    )
    first_frame: Mapped[int] = mapped_column(Integer, primary_key=True)
    last_frame: Mapped[int] = mapped_column(Integer)
    frames: Mapped[int] = mapped_column(Integer)
    ok: Mapped[int] = mapped_column(Integer)
    time_s: Mapped[float | None]
    z_min_mm: Mapped[float | None]
    z_max_mm: Mapped[float | None]
    #: Frames by ``layers``, ``stages`` and ``reasons``; ``poses``: the numbers of the first and the
    #: last pose, and between them those of the two successive ones farthest apart; ``damaged``;
    #: ``bearings``: frames of that quality by layer; ``unknown``: poses of unknown quality.
    body: Mapped[dict[str, Any]] = mapped_column(JSON)


OPEN = ("queued", "running")
ENDED = ("done", "failed", "cancelled")
#: What frames are detected by.
RECIPE = (FlightRow.pad, FlightRow.other_pads, FlightRow.camera)
