"""One of each kind of thing that a server keeps, so that requests have something to be about."""

from __future__ import annotations

import cv2
import httpx
import numpy as np
from web_server import PRESET, store_pad

#: Sixteen to nine, as the preset's frames are.
PICTURE = bytes(cv2.imencode(".png", np.full((36, 64, 3), 90, np.uint8))[1].tobytes())


def keep(client: httpx.Client) -> dict[str, str]:
    """Make a server keep one of each; their ids by what they are.

    Flights stay queued where nobody works them; the live session is of a browser's camera.
    """
    pad = str(store_pad(client)["id"])
    sent = {"Tus-Resumable": "1.0.0", "Upload-Length": str(len(PICTURE))}
    sent["Content-Type"] = "application/offset+octet-stream"
    upload = _id(client.post("/api/v1/uploads", content=PICTURE, headers=sent))
    fields = {"pad": pad, "camera": PRESET, "trace": "true"}
    detected = client.post("/api/v1/detect", files={"image": PICTURE}, data=fields)
    order = {"pad": pad, "camera": PRESET}
    job = {"pad": pad, "uploads": [upload]}
    return {
        "pad": pad,
        "upload": upload,
        "trace": detected.raise_for_status().json()["trace"]["id"],
        "flight": _id(client.post("/api/v1/flights", json={**order, "uploads": [upload]})),
        "session": _id(client.post("/api/v1/live", json={**order, "source": "browser"})),
        "calibration": _id(client.post("/api/v1/calibrations", json=job)),
    }


def _id(answer: httpx.Response) -> str:
    return str(answer.raise_for_status().json()["id"])
