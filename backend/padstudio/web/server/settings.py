"""Every setting and limit of the server, in one class.

Each is read from the environment as ``PADSTUDIO_<NAME>``; docs/settings.md lists them, and a test
holds that list to this class.
"""

from __future__ import annotations

import ipaddress
import os
import sys
from pathlib import Path

from pydantic import Field, ValidationError, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from padstudio.errors import SpecError
from padstudio.live.stream.allowed import AllowedSources
from padstudio.pad import spec
from padstudio.web.server.callbacks.hosts import CallbackHosts

MB = 1_000_000


def default_data_folder() -> Path:
    """The user's own folder for application data, by the platform's custom."""
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "padstudio"
    base = os.environ.get("XDG_DATA_HOME")
    return (Path(base) if base else Path.home() / ".local" / "share") / "padstudio"


def is_loopback(host: str) -> bool:
    """True for ``localhost`` and the loopback addresses."""
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


class Settings(BaseSettings):
    """Settings of one server; immutable once made."""

    model_config = SettingsConfigDict(env_prefix="PADSTUDIO_", frozen=True, extra="forbid")

    host: str = Field("127.0.0.1", description="Address to listen on.")
    port: int = Field(8000, ge=0, le=65535, description="TCP port; 0 takes a free one.")
    token: str | None = Field(
        None,
        min_length=16,
        max_length=200,
        pattern=r"^[A-Za-z0-9_.~-]+$",
        description="Secret that every request must carry; required unless bound to loopback.",
        repr=False,
    )
    allowed_hosts: tuple[str, ...] = Field(
        (),
        description="Further host names to answer to without a token, as a JSON list; for a "
        "reverse proxy that checks users itself.",
    )
    callback_hosts: tuple[str, ...] = Field(
        (),
        description="Hosts that may be called when a flight has ended, host or host:port, as a "
        "JSON list; none by default.",
    )
    callback_secret: str | None = Field(
        None,
        min_length=24,
        max_length=200,
        description="Secret that callbacks are signed with; required where hosts are listed.",
        repr=False,
    )
    data: Path = Field(
        default_factory=default_data_folder,
        description="Data folder: database, pads, cameras, traces.",
    )
    database_url: str | None = Field(
        None,
        description="SQLAlchemy URL of another database than SQLite in the data folder.",
        repr=False,
    )

    workers: int = Field(2, ge=1, le=64, description="Processes that decode, detect and generate.")
    worker_memory_bytes: int = Field(
        3_000 * MB, ge=500 * MB, description="Memory each of them may take (Linux)."
    )
    worker_idle_seconds: float = Field(
        600,
        gt=0,
        le=1e9,
        description="After so long without work a process is ended; the next work starts it again.",
    )
    max_waiting: int = Field(16, ge=0, le=1000, description="Requests that may wait for a process.")
    detect_seconds: float = Field(60, gt=0, le=3600, description="Time for one image.")
    generate_seconds: float = Field(60, gt=0, le=3600, description="Time to generate one pad.")
    paint_seconds: float = Field(120, gt=0, le=3600, description="Time to paint one file.")
    simulate_seconds: float = Field(
        120, gt=0, le=3600, description="Time to simulate one frame, or one map of coverage."
    )

    max_streams: int = Field(
        2000, ge=1, le=100_000, description="Event streams that may be open at a time."
    )
    max_request_bytes: int = Field(
        100_000, ge=1000, description="Largest request body that is no file upload."
    )
    max_upload_bytes: int = Field(
        64 * MB, ge=1000, le=2000 * MB, description="Largest upload of an image or a pad file."
    )
    max_bundle_bytes: int = Field(
        256 * MB, ge=1000, le=512 * MB, description="Largest bundle of a frame."
    )
    max_camera_bytes: int = Field(
        32 * MB, ge=1000, le=32 * MB, description="Largest camera file, with its snapshots."
    )
    # Pillow warns above 89 megapixels by itself, hence the upper end.
    max_image_pixels: int = Field(
        50_000_000, ge=10_000, le=80_000_000, description="Most pixels of an uploaded image."
    )
    max_paint_pixels: int = Field(
        400_000_000, ge=10_000, le=1_000_000_000, description="Most pixels of a painted PNG."
    )
    max_simulated_pixels: int = Field(
        25_000_000, ge=10_000, le=50_000_000, description="Most pixels of a simulated frame."
    )
    max_simulated_frames: int = Field(
        100, ge=1, le=20_000, description="Most frames of one map of coverage."
    )
    simulate_flight_seconds: float = Field(
        1800, gt=0, le=86_400, description="Time to simulate one flight."
    )
    calibrate_seconds: float = Field(
        1800, gt=0, le=86_400, description="Time to calibrate one camera."
    )
    experiment_seconds: float = Field(
        7200, gt=0, le=86_400, description="Time to make one experiment."
    )
    max_flight_frames: int = Field(
        600, ge=1, le=20_000, description="Most frames of one simulated flight."
    )
    live_sources: tuple[str, ...] = Field(
        ("localhost", "127.0.0.1", "[::1]"),
        description="Hosts whose streams may be opened: host, host:port or a network, as a JSON "
        "list; this machine alone by default.",
    )
    live_devices: bool = Field(
        False, description="Capture devices of the server's machine may be opened."
    )
    live_files: bool = Field(
        False, description="Files of the server's disk may be opened as streams."
    )
    max_live: int = Field(2, ge=1, le=16, description="Live sessions that may be open at a time.")
    live_idle_seconds: float = Field(
        60, gt=0, le=86_400, description="After so long without a watcher a live session is ended."
    )
    max_window: int = Field(
        spec.MAX_WINDOW,
        ge=2,
        le=spec.MAX_WINDOW,
        description="Largest window (b × b cells) of a new pad.",
    )
    max_levels: int = Field(
        spec.MAX_LEVELS, ge=2, le=spec.MAX_LEVELS, description="Most grey levels (Y) of a new pad."
    )
    max_cells: int = Field(
        spec.MAX_CELLS, ge=2, le=spec.MAX_CELLS, description="Most rows or columns of a new pad."
    )
    keep_traces: int = Field(200, ge=1, description="Traces kept; the oldest go first.")
    keep_trace_bytes: int = Field(
        4_000 * MB, ge=10 * MB, description="Disk that the kept traces may take together."
    )
    keep_experiments: int = Field(50, ge=1, description="Experiments kept; the oldest go first.")

    max_flight_bytes: int = Field(
        32_000 * MB, ge=1000, description="Largest upload of a video or of a zip of stills."
    )
    keep_upload_bytes: int = Field(
        200_000 * MB, ge=1000, description="Disk that all uploads may take together."
    )
    max_unfinished_uploads: int = Field(
        1000, ge=1, description="Uploads that may be under way at a time."
    )
    upload_expires_seconds: float = Field(
        86_400, gt=0, description="After so long without bytes an unfinished upload is removed."
    )
    max_telemetry_bytes: int = Field(64 * MB, ge=1000, description="Largest telemetry file.")
    max_zip_files: int = Field(20_000, ge=1, description="Most files in a zip of stills.")
    max_zip_bytes: int = Field(64_000 * MB, ge=1000, description="Most that a zip may unpack to.")
    max_zip_ratio: float = Field(
        200, ge=1, description="Most that a zip, or a file in it, may grow by when unpacked."
    )

    scheduler: str | None = Field(
        None,
        pattern=r"^tls://",
        description="Dask scheduler of a cluster, tls://host:port, instead of processes here.",
    )
    scheduler_ca: str | None = Field(
        None, description="PEM file of the authority that the cluster's certificates are of."
    )
    scheduler_cert: str | None = Field(None, description="PEM file of this server's certificate.")
    scheduler_key: str | None = Field(None, description="PEM file of its key.")
    storage: str | None = Field(
        None,
        description="Folder or fsspec URL (s3://bucket/prefix) through which workers on other "
        "machines read uploads.",
    )
    chunk_frames: int = Field(
        120, ge=1, le=100_000, description="Frames of a video that one task reads, or a few more."
    )
    chunk_attempts: int = Field(
        3, ge=1, le=20, description="Worker processes that a task may cost before it fails."
    )
    max_flights: int = Field(
        1000, ge=1, description="Flights that may be queued or running at a time."
    )
    max_frames: int = Field(2_000_000, ge=1, description="Most frames of one video.")
    keep_picture_bytes: int = Field(
        4_000 * MB, ge=10 * MB, description="Disk that the kept pictures of frames may take."
    )
    keep_frame_bytes: int = Field(
        8_000 * MB,
        ge=500 * MB,
        description="Disk that decoded frames about those that are looked at may take.",
    )
    keep_proxy_bytes: int = Field(
        20_000 * MB, ge=500 * MB, description="Disk that small pictures of all frames may take."
    )

    @field_validator("data")
    @classmethod
    def _absolute(cls, value: Path) -> Path:
        return value.expanduser().absolute()

    @field_validator("callback_hosts")
    @classmethod
    def _readable(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        CallbackHosts(value)
        return value

    @field_validator("live_sources")
    @classmethod
    def _openable(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        AllowedSources(value)
        return value

    @model_validator(mode="after")
    def _signed(self) -> Settings:
        if self.callback_hosts and self.callback_secret is None:
            raise ValueError(
                "callbacks are signed: set PADSTUDIO_CALLBACK_SECRET beside "
                "PADSTUDIO_CALLBACK_HOSTS"
            )
        return self

    @property
    def lacks_token(self) -> bool:
        """True where anybody on the network could ask, and nothing tells who may."""
        return self.token is None and not is_loopback(self.host)


def load_settings(**overrides: object) -> Settings:
    """Settings from the environment, with overrides that are not None.

    Raises
    ------
    SpecError
        If one is unknown or out of range, naming it.
    """
    given = {name: value for name, value in overrides.items() if value is not None}
    try:
        return Settings(**given)  # type: ignore[arg-type]
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        name = "_".join(str(part) for part in first["loc"])
        place = f"setting {name} (PADSTUDIO_{name.upper()}): " if name else ""
        raise SpecError(
            place + first["msg"].removeprefix("Value error, "), code="invalid_setting"
        ) from error
