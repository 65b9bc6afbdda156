"""The tables of the database; `padstudio.store.migrations` builds them."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import JSON, BigInteger, DateTime, Dialect, String, Text
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.types import TypeDecorator


class UtcDateTime(TypeDecorator[datetime]):
    """A point in time, read in UTC: SQLite keeps no zone, PostgreSQL gives that of its session."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class Base(DeclarativeBase):
    """Root of the tables."""


class StoredFile:
    """Columns of a file that is kept whole beside what lists show of it."""

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, index=True)
    summary: Mapped[dict[str, Any]] = mapped_column(JSON)
    content: Mapped[str] = mapped_column(Text, deferred=True)


class PadRow(StoredFile, Base):
    """A stored pad: its pad file."""

    __tablename__ = "pads"


class CameraRow(StoredFile, Base):
    """A stored camera: its ROS YAML file."""

    __tablename__ = "cameras"


class TraceRow(Base):
    """A kept detection; its pictures are in ``traces/<id>/``."""

    __tablename__ = "traces"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, index=True)
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    body: Mapped[dict[str, Any]] = mapped_column(JSON)


class PresetRow(Base):
    """Named settings of the detector."""

    __tablename__ = "presets"

    name: Mapped[str] = mapped_column(String(60), primary_key=True)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime)
    method: Mapped[str] = mapped_column(String(10))
    params: Mapped[dict[str, Any]] = mapped_column(JSON)


class UploadRow(Base):
    """An upload; its bytes are in ``uploads/partial/<id>``, or ``uploads/files/<sha256>``.

    How far a partial one has come is the size of its file, which no database can know better.
    """

    __tablename__ = "uploads"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, index=True)
    name: Mapped[str] = mapped_column(String(200))
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    #: The protocol's header, to be given back as it came.
    tus_metadata: Mapped[str] = mapped_column(Text)
    #: When a partial upload is given up; None once it is complete.
    expires_at: Mapped[datetime | None] = mapped_column(UtcDateTime, index=True)
    #: Bytes from here on wait for their checksum; None where all are taken.
    unverified_from: Mapped[int | None] = mapped_column(BigInteger)
    sha256: Mapped[str | None] = mapped_column(String(64), index=True)
    kind: Mapped[str | None] = mapped_column(String(20))
    media_type: Mapped[str | None] = mapped_column(String(60))
