"""Where the web pages' files lie: in the installed package, or in the repository."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def web_folder(name: str) -> Path:
    """Folder ``frontend``, ``templates`` or ``samples``.

    An installed wheel carries them in ``padstudio/_web``; a source tree has them at its top.
    """
    installed = _PACKAGE / "_web" / name
    return installed if installed.is_dir() else _PACKAGE.parents[1] / name


def sample_folder() -> Path:
    """Folder of the tour's sample: ``pad.json``, ``camera.yaml``, frames and ``truth.json``."""
    return web_folder("samples")
