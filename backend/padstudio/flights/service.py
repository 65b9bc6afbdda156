"""All there is to do with flights: the one object that the server holds."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy.orm import Session, sessionmaker

from padstudio import __version__
from padstudio.errors import ConflictError, NotFoundError, SpecError
from padstudio.flights.callbacks import Callbacks
from padstudio.flights.chunks import Chunks
from padstudio.flights.cluster.task import Engine, Task
from padstudio.flights.jobs import FlightOrder, Flights
from padstudio.flights.pictures.bounded import BoundedFolder
from padstudio.flights.pictures.proxies import ProxyJob, ProxyStore
from padstudio.flights.pictures.shelves import FRAMES_BEFORE, shelf_job
from padstudio.flights.pictures.stages import PictureCache, PictureJob
from padstudio.flights.recorded import from_rows as recorded
from padstudio.flights.results.charts import FigureRows
from padstudio.flights.results.compared_rows import Comparisons
from padstudio.flights.results.frames import Results
from padstudio.flights.results.summaries import Summaries
from padstudio.flights.runner import Runner
from padstudio.flights.tasks import from_rows
from padstudio.flights.tasks.detectors import params_from
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.flights.vehicle.answers import VehicleAnswers
from padstudio.media.remote import Storage
from padstudio.pad.spec import Pad
from padstudio.store.database.flight_tables import OPEN, ChunkRow, FlightRow
from padstudio.store.uploads.rows import Upload
from padstudio.store.uploads.uploads import Uploads
from padstudio.vision.detector import check_pads


@dataclass(frozen=True, kw_only=True)
class FlightOptions:
    """How flights are worked on, and how much of them is kept.

    Attributes
    ----------
    pictures : Path
        Folder for kept pictures; emptied.
    keep_picture_bytes : int
        What they may take.
    proxies : Path or None
        Folder for small pictures of all frames; None: beside `pictures`.
    keep_proxy_bytes : int
        What they may take.
    shelves : Path or None
        Folder for decoded frames, as of `proxies`; emptied.
    keep_frame_bytes : int
        What they may take.
    shares_disk : bool
        Tasks write proxies on the way; not where they run on other machines.
    limits : WorkLimits
    max_open : int
        Flights that may be queued or running at a time.
    attempts : int
        Dead or hanging workers that one chunk may cost.
    idle_s : float or None
        After so long without work a cluster's scheduler is let go of.
    """

    pictures: Path
    keep_picture_bytes: int = 4_000_000_000
    proxies: Path | None = None
    keep_proxy_bytes: int = 20_000_000_000
    shelves: Path | None = None
    keep_frame_bytes: int = 8_000_000_000
    shares_disk: bool = True
    limits: WorkLimits = field(default_factory=WorkLimits)
    max_open: int = 1000
    attempts: int = 3
    idle_s: float | None = None


class FlightService:
    """Takes orders, has them worked on, and shows what came out.

    Parameters
    ----------
    session : sessionmaker
    uploads : Uploads
    engine : Engine
    storage : Storage
    options : FlightOptions

    Attributes
    ----------
    flights : Flights
    callbacks : Callbacks
    results : Results
    summaries : Summaries
    charts : FigureRows
    vehicle : VehicleAnswers
    comparisons : Comparisons
    pictures : PictureCache
    proxies : ProxyStore
    shelves : BoundedFolder
        Decoded frames.
    """

    def __init__(
        self,
        session: sessionmaker[Session],
        uploads: Uploads,
        engine: Engine,
        storage: Storage,
        options: FlightOptions,
    ) -> None:
        self.flights = Flights(session, options.max_open)
        self.callbacks = Callbacks(session)
        self.results, self.summaries = Results(session), Summaries(session)
        self.charts = FigureRows(session)
        self.vehicle = VehicleAnswers(session)
        self.comparisons = Comparisons(session)
        self.limits, self._shares_disk = options.limits, options.shares_disk
        self._uploads, self._storage = uploads, storage
        chunks = Chunks(session, attempts=options.attempts)
        self._runner = Runner(self.flights, chunks, engine, self._task_of, idle_s=options.idle_s)
        self.pictures = PictureCache(options.pictures, options.keep_picture_bytes)
        folder = options.shelves or options.pictures.with_name("frames")
        self.shelves = BoundedFolder(folder, options.keep_frame_bytes, is_emptied=True)
        proxies = options.proxies or options.pictures.with_name("proxies")
        self.proxies = ProxyStore(proxies, options.keep_proxy_bytes)

    def start(self) -> None:
        """Go on with what an earlier server left unfinished, and take new work."""
        self._runner.start()

    def close(self) -> None:
        """Stop; unfinished work goes on at the next start."""
        self._runner.close()

    @property
    def trouble(self) -> str | None:
        """Why queued work does not go on at present, a sentence; None where it does."""
        return self._runner.trouble

    def order(self, order: FlightOrder) -> FlightRow:
        """Check and queue a flight.

        Raises
        ------
        NotFoundError, ConflictError
            If an upload is missing or not complete.
        SpecError
            If the uploads or the pads do not go together, or a parameter is wrong.
        LimitError
            If too many flights are queued.
        """
        params_from(order.request["params"])
        pads = [Pad.loads(text) for text in (order.pad, *order.other_pads)]
        check_pads(pads, order.request["method"])
        uploads = [self._complete(upload) for upload in order.uploads]
        if recorded.is_recorded(order.request):
            recorded.check_recorded(uploads)
        else:
            check_uploads(uploads)
        # The poses of a live session are those of the program that ran then.
        program = order.request.get("live", {}).get("program", __version__)
        request = dict(order.request) | {"version": program}
        flight = self.flights.create(replace(order, request=request))
        self._runner.wake()
        return flight

    def rerun(self, flight_id: str, change: Callable[[FlightOrder], FlightOrder]) -> FlightRow:
        """Queue a flight of the same uploads beside another one; raises as `order`.

        Of a live session's recording the frames are read anew, all of them.

        Parameters
        ----------
        flight_id : str
        change : callable
            Gives the new order for the first one's. Where its request has ``only``, with
            ``flight`` and ``reason``, it is read for the failed frames of that flight alone.

        Raises
        ------
        ConflictError
            If failed frames are asked for of a flight that has not ended.
        SpecError
            If it has none.
        """
        first = self.flights.get(flight_id, texts=True)
        uploads = self.flights.uploads(first)
        if recorded.is_recorded(first.request):
            uploads = tuple(u for u in uploads if self._uploads.get(u).kind == "video")
        order = FlightOrder(
            first.name,
            uploads,
            first.pad,
            first.camera,
            {name: value for name, value in first.request.items() if name != "live"},
            rerun_of=first.id,
            other_pads=first.other_pads or (),
        )
        changed = replace(change(order), rerun_of=first.id)
        self._chosen(changed.request)
        return self.order(changed)

    def _chosen(self, request: Mapping[str, Any]) -> bytes | None:
        """The frames that a request is limited to, int64 little-endian; None is all."""
        only = request.get("only")
        if not only:
            return None
        flight = self.flights.get(only["flight"])
        if flight.state in OPEN:
            raise ConflictError(
                "its failed frames are known when the flight has ended; wait for it, or cancel it",
                code="not_ended",
            )
        numbers = self.results.failed(flight, only["reason"])
        if not numbers:
            reason = f" for the reason {only['reason']}" if only["reason"] else ""
            raise SpecError(
                f"no frame of that flight failed{reason}; run it again as a whole",
                code="no_frames",
            )
        return np.array(numbers, "<i8").tobytes()

    def pictured(self, flight: FlightRow) -> FlightRow:
        """The run that has the small pictures of a flight's frames; with its texts.

        A run of chosen frames shows those between them, too, as the run has that they were chosen
        of, while there is that one.
        """
        only = flight.request.get("only")
        with contextlib.suppress(NotFoundError):
            while only:
                flight = self.flights.get(only["flight"], texts=True)
                only = flight.request.get("only")
        return flight

    def cancel(self, flight_id: str) -> FlightRow:
        """As `Flights.cancel`."""
        flight = self.flights.cancel(flight_id)
        self._runner.wake()
        return flight

    def retry(self, flight_id: str) -> FlightRow:
        """As `Flights.retry`."""
        flight = self.flights.retry(flight_id)
        self._runner.wake()
        return flight

    def delete(self, flight_id: str) -> None:
        """As `Flights.delete`."""
        flight = self.flights.get(flight_id)
        self.flights.delete(flight_id)
        self.proxies.drop(flight)
        self._runner.wake()

    def picture_job(self, flight_id: str, number: int, folder: Path) -> PictureJob:
        """The job that paints a frame into a folder.

        Raises
        ------
        NotFoundError
            If there is no such flight, or it does not read that frame.
        """
        flight = self.flights.get(flight_id, texts=True)
        chunk = self.results.chunk_of(flight, number)
        recipe, pixels = from_rows.recipe_of(flight), self.limits.max_pixels
        if not chunk.pts:
            still = from_rows.still_part(flight.sources, number)
            return PictureJob(recipe, still, folder, pixels)
        source = flight.sources[chunk.source]
        part = from_rows.video_part(source, chunk.pts)
        place = from_rows.numbers_of(flight, chunk).index(number)
        lead_in = part.between(max(0, place - FRAMES_BEFORE), place + 1)
        if not part.is_stream:
            return PictureJob(recipe, lead_in, folder, pixels)
        stream = source["upload"] + (part.recording.topic if part.recording else "")
        name = hashlib.sha256(stream.encode()).hexdigest()[:32]
        shelf = shelf_job(self.shelves.root / name, part, place, pixels)
        return PictureJob(recipe, lead_in, folder, pixels, shelf)

    def proxy_job(self, flight: FlightRow, number: int) -> tuple[ProxyJob, ChunkRow]:
        """The job that makes the proxies of a frame's chunk; raises as `picture_job`."""
        chunk = self.results.chunk_of(flight, number)
        part, target = from_rows.part_of(flight, chunk), self.proxies.target(flight)
        return ProxyJob(part, chunk.first_frame, target, self.limits.max_pixels), chunk

    def _task_of(self, flight: FlightRow, chunk: ChunkRow) -> Task:
        is_recorded = recorded.is_recorded(flight.request)
        if chunk.number and is_recorded:
            return recorded.frames_task(flight, chunk)
        if chunk.number:
            self.proxies.trim()
            keeps = self._shares_disk and not flight.request.get("only")
            target = self.proxies.target(flight) if keeps else None
            return from_rows.frames_task(flight, chunk, self.limits, target)
        uploads = [self._complete(upload) for upload in self.flights.uploads(flight)]
        if is_recorded:
            found = [(upload, self._uploads.path(upload.id)) for upload in uploads]
            return recorded.plan_task(flight, found, self._storage.place, self.limits)
        files = [(u.id, u.kind or "", u.name, self._uploads.path(u.id)) for u in uploads]
        only = self._chosen(flight.request)
        return from_rows.plan_task(flight, files, self._storage.place, self.limits, only)

    def _complete(self, upload_id: str) -> Upload:
        self._uploads.path(upload_id)
        return self._uploads.get(upload_id)


def check_uploads(uploads: Sequence[Upload]) -> None:
    """Refuse uploads that do not make one flight.

    Raises
    ------
    SpecError
        If there are none to read frames from, videos among stills, or telemetry without a video.
    """
    kinds = [upload.kind for upload in uploads]
    if "live" in kinds:
        raise SpecError(
            "what was recorded live opens with the poses that it has: POST it to "
            "/api/v1/flights/from-recording, or send its videos alone",
            code="live_recording",
        )
    videos = kinds.count("video") + kinds.count("recording")
    stills = kinds.count("still") + kinds.count("stills")
    if not videos and not stills:
        raise SpecError(
            "a flight is made of at least one video, recording, still or zip of stills; telemetry "
            "alone has no frames",
            code="mixed_uploads",
        )
    if videos and stills:
        raise SpecError(
            "videos or recordings and stills do not go into one flight; make a flight of each",
            code="mixed_uploads",
        )
    if kinds.count("telemetry") > min(1, videos):
        raise SpecError(
            "a flight takes one telemetry file, beside a video; leave the others out",
            code="mixed_uploads",
        )
    if len({upload.id for upload in uploads}) < len(uploads):
        raise SpecError("an upload is named twice; name each once", code="mixed_uploads")
