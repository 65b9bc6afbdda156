"""Jobs for a server that is harmed, and what became of them."""

from __future__ import annotations

import base64
import io
import json
import time
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
from places import ROOT

API = "/api/v1"
OVER = ("done", "failed", "cancelled")
SAMPLES = ROOT / "samples"
VIDEO = SAMPLES / "flight" / "landing.mp4"
_TUS = {"Tus-Resumable": "1.0.0"}
# Of the jobs, one in so many sends a file of its own, in pieces.
_OWN_UPLOAD = 10
_PIECE_BYTES = 60_000
_AT_A_TIME = 12
_VIDEO_FRAMES = 24
# An upload that another request is at, a server that ends or whose database is away, a full disk.
_FOR_NOW = (409, 423, 503, 507)


class AwayError(Exception):
    """The server is away, or refuses for now."""


@dataclass
class Job:
    """A flight that is to be ordered once and done."""

    number: int
    kind: str
    flight: str | None = None
    state: str = "not ordered"
    seen: int = 0
    upload: str | None = None
    error: Any = None


@dataclass
class Count:
    """What became of the frames of all jobs."""

    frames: int = 0
    lost: int = 0
    doubled: int = 0
    different: int = 0
    taken_back: int = 0
    failed: int = 0
    unfinished: int = 0
    errors: list[Any] = field(default_factory=list)

    @property
    def is_good(self) -> bool:
        """Nothing is missing, and nothing wrong."""
        bad = (self.lost, self.doubled, self.different, self.taken_back)
        return not any((*bad, self.failed, self.unfinished))


class Work:
    """Jobs, ordered a few at a time, and each known by a key, so that none is ordered twice.

    Parameters
    ----------
    client : httpx.Client
        Of a server that is not harmed yet: it takes pad, camera and files, and reads each kind
        of job once.
    jobs : int

    Attributes
    ----------
    faults : list of str
        Answers that no client should get.
    """

    def __init__(self, client: httpx.Client, jobs: int) -> None:
        self._client = client
        self.faults: list[str] = []
        self._of_stills = self._recipe(SAMPLES)
        self._of_video = self._recipe(SAMPLES / "flight")
        stills = _stills(0, ["height_1300mm.jpg", "height_450mm.jpg", "another_pad.jpg"])
        self._uploads = {
            "video": self._sent(VIDEO.name, VIDEO.read_bytes()),
            "stills": self._sent("stills.zip", stills),
        }
        kinds = [_kind_of(number) for number in range(jobs)]
        self.jobs = [Job(number, kind) for number, kind in enumerate(kinds)]
        self._taken_back = 0
        first = {kind: kinds.index(kind) for kind in dict.fromkeys(kinds)}
        self._truth = {kind: self._undisturbed(self.jobs[n]) for kind, n in first.items()}

    def go_on(self, client: httpx.Client) -> None:
        """Order what is next, and look at what is open.

        Raises
        ------
        AwayError
        """
        self._client = client
        is_open = [job for job in self.jobs if job.flight and job.state not in OVER]
        for job in is_open:
            self._look(job)
        waiting = [job for job in self.jobs if job.flight is None]
        for job in waiting[: max(0, _AT_A_TIME - len(is_open))]:
            self._order(job)

    @property
    def over(self) -> int:
        """Jobs that have ended."""
        return sum(job.state in OVER for job in self.jobs)

    def count(self) -> Count:
        """Compare what came out with what comes out undisturbed."""
        count = Count(taken_back=self._taken_back)
        for job in self.jobs:
            truth = self._truth[job.kind]
            count.frames += len(truth)
            if job.state not in OVER:
                count.unfinished += 1
                continue
            if job.state != "done":
                count.failed += 1
                count.errors.append(job.error)
            lines = self._lines(job)
            found = {line["frame"]: line for line in lines}
            count.lost += len(truth.keys() - found.keys())
            count.doubled += len(lines) - len(found)
            others = [n for n in found.keys() & truth.keys() if found[n] != truth[n]]
            count.different += len(others)
            if others:
                count.errors.append(_difference(job, found[others[0]], truth[others[0]]))
        return count

    def _undisturbed(self, job: Job) -> dict[int, Any]:
        while job.flight is None:
            self._order(job)
        while job.state not in OVER:
            time.sleep(0.5)
            self._look(job)
        assert job.state == "done", job.error
        return {line["frame"]: line for line in self._lines(job)}

    def _order(self, job: Job) -> None:
        upload = self._uploads.get(job.kind) or self._own_upload(job)
        if upload is None:
            return
        is_video = job.kind == "video"
        recipe = self._of_video if is_video else self._of_stills
        order = recipe | {"uploads": [upload]} | ({"end_frame": _VIDEO_FRAMES} if is_video else {})
        answer = self._ask(
            "POST",
            "/flights",
            json=order,
            headers={"Idempotency-Key": f"soak-flight-{job.number:04d}"},
        )
        job.flight = str(answer.json()["id"])

    def _look(self, job: Job) -> None:
        shown = self._ask("GET", f"/flights/{job.flight}").json()
        self._taken_back += max(0, job.seen - shown["frames_done"])
        job.state, job.seen, job.error = shown["state"], shown["frames_done"], shown["error"]

    def _own_upload(self, job: Job) -> str | None:
        """The next piece of a job's own file; its upload where that was the last one."""
        content = _stills(job.number, ["height_450mm.jpg"])
        if job.upload is None:
            job.upload = self._created(f"own-{job.number}.zip", len(content))
            return None
        place = f"/uploads/{job.upload}"
        offset = int(self._ask("HEAD", place, headers=_TUS).headers["Upload-Offset"])
        if offset < len(content):
            about = {
                "Upload-Offset": str(offset),
                "Content-Type": "application/offset+octet-stream",
            }
            piece = content[offset : offset + _PIECE_BYTES]
            self._ask("PATCH", place, headers=_TUS | about, content=piece)
            return None
        return job.upload

    def _created(self, name: str, length: int) -> str:
        named = "filename " + base64.b64encode(name.encode()).decode()
        about = {"Upload-Length": str(length), "Upload-Metadata": named}
        return str(self._ask("POST", "/uploads", headers=_TUS | about).json()["id"])

    def _sent(self, name: str, content: bytes) -> str:
        upload = self._created(name, len(content))
        self._send(f"/uploads/{upload}", 0, content)
        return upload

    def _send(self, place: str, offset: int, piece: bytes) -> None:
        about = {"Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"}
        self._ask("PATCH", place, headers=_TUS | about, content=piece)

    def _recipe(self, folder: Path) -> dict[str, Any]:
        return {
            "pad": self._file("/pads/import", SAMPLES / "pad.json"),
            "camera": self._file("/cameras", folder / "camera.yaml"),
        }

    def _file(self, place: str, path: Path) -> str:
        answer = self._ask("POST", place, files={"file": (path.name, path.read_bytes())})
        return str(answer.json()["id"])

    def _lines(self, job: Job) -> list[Any]:
        """Lines of a flight's poses, without what no two runs have in common."""
        text = self._ask("GET", f"/flights/{job.flight}/export/jsonl").text
        lines = [json.loads(line) for line in text.splitlines()]
        for line in lines:
            line.pop("elapsed_ms", None)
            line.pop("source", None)
        return [line for line in lines if "frame" in line]

    def _ask(self, method: str, place: str, **given: Any) -> httpx.Response:
        try:
            answer = self._client.request(method, API + place, **given)
        except httpx.HTTPError as error:
            raise AwayError(str(error)) from error
        if answer.status_code in _FOR_NOW:
            raise AwayError(answer.text)
        if answer.is_error:
            self.faults.append(f"{method} {place}: {answer.status_code} {answer.text[:500]}")
            raise AwayError(answer.text)
        return answer


def _difference(job: Job, found: dict[str, Any], truth: dict[str, Any]) -> str:
    keys = sorted(k for k in found.keys() | truth.keys() if found.get(k) != truth.get(k))
    told = ", ".join(f"{k}: {found.get(k)} for {truth.get(k)}" for k in keys)
    return f"job {job.number} ({job.kind}), frame {truth['frame']}: {told}"[:500]


def _kind_of(number: int) -> str:
    if number % _OWN_UPLOAD == _OWN_UPLOAD - 1:
        return "own"
    return "stills" if number % 2 else "video"


def _stills(number: int, names: list[str]) -> bytes:
    """A zip of samples that is another one for each number."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as file:
        for name in names:
            file.write(SAMPLES / name, f"{number}-{name}")
    return packed.getvalue()
