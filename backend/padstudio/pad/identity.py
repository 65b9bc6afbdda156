"""What tells one pad from another: a short id, and a line of text for its QR code."""

from __future__ import annotations

import base64
import hashlib
from typing import Any

from padstudio.pad.spec import Pad

# Begins the QR code's line: what it is, and the version of its form.
_PREFIX = "padstudio:1"
# Left out where nobody knows them.
_OPTIONAL = ("seed", "method", "unique", "distance", "layer_fields")


def pad_id(pad: Pad) -> str:
    """Eight letters and digits of what is printed: fields, cell sizes, levels.

    Name, quiet margin and measured scale do not count: they change, the print stays.
    """
    digest = hashlib.sha256(f"{pad.levels}".encode())
    for layer in sorted(pad.layers, key=lambda layer: layer.channel):
        head = f"|{layer.channel} {layer.rows} {layer.cols} {layer.cell_mm:.6g}|"
        digest.update(head.encode() + layer.field.tobytes())
    return base64.b32encode(digest.digest()).decode()[:8]


def label_text(pad: Pad) -> str:
    """The line of a pad's QR code, such as ``padstudio:1;id=…;b=5;y=2;q=0;red=125x125x10``."""
    words = [_PREFIX, f"id={pad_id(pad)}", f"b={pad.window}", f"y={pad.levels}"]
    words.append(f"q={pad.quiet_mm:.6g}")
    if pad.seed is not None:
        words.append(f"s={pad.seed}")
    words += [
        f"{layer.channel}={layer.rows}x{layer.cols}x{layer.cell_mm:.6g}" for layer in pad.layers
    ]
    return ";".join(words)


def describe(pad: Pad) -> dict[str, Any]:
    """The pad's spec and seed, without its fields, JSON-serialisable."""
    spec: dict[str, Any] = {
        "id": pad_id(pad),
        "name": pad.name,
        "window": pad.window,
        "levels": pad.levels,
        "quiet_mm": pad.quiet_mm,
    }
    spec |= {key: getattr(pad, key) for key in _OPTIONAL if getattr(pad, key) is not None}
    if pad.visible_lines:
        spec["visible_lines"] = True
    spec["layers"] = [
        {
            "channel": layer.channel,
            "cell_mm": layer.cell_mm,
            "rows": layer.rows,
            "cols": layer.cols,
        }
        for layer in pad.layers
    ]
    return spec
