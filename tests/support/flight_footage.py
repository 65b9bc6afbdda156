"""A small flight for the browser: the landing with blanked frames, and telemetry."""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import httpx
import numpy as np
from browser_support import FOOTAGE

#: Calibration of the footage; its aspect is the small video's too.
FLIGHT_CAMERA = FOOTAGE / "camera_drone_2k7.yaml"
FRAMES = 24
BLANK = frozenset({7, 8, 9, 15})
FPS = 10
#: By which the telemetry's heights are below those of the truth.
TELEMETRY_SCALE = 1 / 1.08
# The landing alone covers too little height to judge a slope by.
_TELEMETRY_OFFSET_M = 0.4
# 0.4 of the footage, of its camera's aspect.
_WIDTH_PX, _HEIGHT_PX = 1088, 612
_EVERY = 2


def write_flight(folder: Path) -> tuple[Path, Path]:
    """Write ``small.mp4`` and ``small.srt``; `BLANK` frames are grey."""
    video, telemetry = folder / "small.mp4", folder / "small.srt"
    truth = json.loads((FOOTAGE / "flights" / "landing.truth.json").read_text())["frames"]
    cues = []
    with (
        av.open(str(FOOTAGE / "flights" / "landing.mp4")) as source,
        av.open(str(video), "w") as out,
    ):
        stream = out.add_stream("libx264", rate=FPS)
        stream.width, stream.height = _WIDTH_PX, _HEIGHT_PX
        stream.pix_fmt, stream.options = "yuv420p", {"crf": "16", "preset": "veryfast", "g": "8"}
        frames = (frame for place, frame in enumerate(source.decode(video=0)) if not place % _EVERY)
        for number, frame in zip(range(FRAMES), frames, strict=False):
            small = frame.reformat(stream.width, stream.height, "bgr24").to_ndarray()
            picture = np.full_like(small, 90) if number in BLANK else small
            shown = av.VideoFrame.from_ndarray(picture, "bgr24")
            shown.pts, shown.time_base = number, Fraction(1, FPS)
            out.mux(stream.encode(shown))
            height_m = truth[number * _EVERY]["position_mm"][2] / 1000
            cues.append(_cue(number, height_m * TELEMETRY_SCALE + _TELEMETRY_OFFSET_M))
        out.mux(stream.encode())
    telemetry.write_text("\n".join(cues))
    return video, telemetry


def _cue(number: int, height_m: float) -> str:
    start, end = number * 1000 // FPS, (number + 1) * 1000 // FPS
    times = " --> ".join(f"00:00:{ms // 1000:02d},{ms % 1000:03d}" for ms in (start, end))
    return (
        f"{number + 1}\n{times}\nFrameCnt: {number + 1}\n"
        f"[latitude: 47.1] [longitude: 8.5] [rel_alt: {height_m:.3f} abs_alt: 400.0]\n"
    )


def order_flight(studio_url: str, files: Iterable[Path], pad: Path, camera: Path) -> str:
    """Upload files, have them analysed with a pad and a camera, and wait; the flight's id."""
    with httpx.Client(base_url=f"{studio_url}/api/v1", timeout=60, trust_env=False) as api:
        ids = {
            word: api.post(address, files={"file": (path.name, path.read_bytes())}).json()["id"]
            for word, address, path in (
                ("pad", "/pads/import", pad),
                ("camera", "/cameras", camera),
            )
        }
        uploads = [_upload(api, path) for path in files]
        flight = api.post("/flights", json={"uploads": uploads, **ids}).raise_for_status().json()
        while flight["state"] in ("queued", "running"):
            time.sleep(0.2)
            flight = api.get(f"/flights/{flight['id']}").raise_for_status().json()
    assert flight["state"] == "done", flight["error"]
    return str(flight["id"])


def _upload(api: httpx.Client, path: Path) -> str:
    headers = {
        "Tus-Resumable": "1.0.0",
        "Upload-Length": str(path.stat().st_size),
        "Upload-Metadata": f"filename {base64.b64encode(path.name.encode()).decode()}",
        "Content-Type": "application/offset+octet-stream",
    }
    answer = api.post("/uploads", headers=headers, content=path.read_bytes()).raise_for_status()
    return str(answer.json()["id"])
