"""``padstudio cameras``: the nominal cameras."""

from __future__ import annotations

import typer

from padstudio.cli.support import show_table
from padstudio.geometry import presets


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(cameras)


def cameras() -> None:
    """List the nominal cameras that --camera takes in place of a file."""
    show_table(
        ("camera", "size", "focal length", "readout", "id"),
        [
            (
                preset.camera.name,
                f"{preset.camera.width} x {preset.camera.height}",
                f"{preset.camera.focal_px:.0f} px",
                _readout(preset.camera.readout_ms),
                preset.id,
            )
            for preset in presets.PRESETS.values()
        ],
        caption=presets.NOTE,
        # To be copied.
        whole=("id",),
    )


def _readout(readout_ms: float | None) -> str:
    return "" if readout_ms is None else f"{readout_ms:g} ms"
