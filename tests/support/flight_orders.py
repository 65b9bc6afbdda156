"""Orders of flights for tests: a small pad, a small camera, uploads of files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import videos

from padstudio.flights.jobs import FlightOrder
from padstudio.geometry.camera import Camera
from padstudio.store.store import Store

PAD = (
    '{"format": "padstudio.pad", "version": 1, "name": "tiny", "window": 2, "levels": 2, '
    '"layers": [{"channel": "red", "cell_mm": 10.0, "codes": ["001", "011", "110"]}]}'
)
REQUEST: dict[str, Any] = {
    "method": "dense",
    "params": {},
    "first_frame": 0,
    "end_frame": None,
    "stride": 1,
    "apply_rotation": True,
}


def camera(width: int = videos.WIDTH, height: int = videos.HEIGHT) -> str:
    """A camera file."""
    matrix = [[width, 0, width / 2], [0, width, height / 2], [0, 0, 1]]
    return Camera(width, height, matrix, [0, 0, 0, 0]).to_ros_yaml()


def upload(store: Store, path: Path) -> str:
    """Store a file as an upload; its id."""
    data = path.read_bytes()
    created = store.uploads.create(path.name, len(data))
    append = store.uploads.append(created.id, 0)
    append.write(data)
    append.commit()
    append.close()
    return store.uploads.finish(created.id).id


def order(*uploads: str, **request: Any) -> FlightOrder:
    """An order of a flight."""
    return FlightOrder("flight", uploads, PAD, camera(), REQUEST | request)
