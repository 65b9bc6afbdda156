"""All there is to do with flights: the one object that the server holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from sqlalchemy.orm import Session, sessionmaker

from padstudio.errors import SpecError
from padstudio.flights.chunks import Chunks
from padstudio.flights.cluster.task import Engine, Task
from padstudio.flights.jobs import FlightOrder, Flights
from padstudio.flights.pictures.stages import Kind, PictureCache, PictureJob, picture_job
from padstudio.flights.results.charts import FigureRows
from padstudio.flights.results.frames import Results
from padstudio.flights.results.summaries import Summaries
from padstudio.flights.runner import Runner
from padstudio.flights.tasks import from_rows
from padstudio.flights.tasks.detectors import params_from
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.remote import Storage
from padstudio.store.database.flight_tables import ChunkRow, FlightRow
from padstudio.store.uploads.rows import Upload
from padstudio.store.uploads.uploads import Uploads


@dataclass(frozen=True, kw_only=True)
class FlightOptions:
    """How flights are worked on, and how much of them is kept.

    Attributes
    ----------
    pictures : Path
        Folder for kept pictures; emptied.
    keep_picture_bytes : int
        What they may take.
    limits : WorkLimits
    max_open : int
        Flights that may be queued or running at a time.
    attempts : int
        Dead or hanging workers that one chunk may cost.
    """

    pictures: Path
    keep_picture_bytes: int = 4_000_000_000
    limits: WorkLimits = field(default_factory=WorkLimits)
    max_open: int = 1000
    attempts: int = 3


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
    results : Results
    summaries : Summaries
    charts : FigureRows
    pictures : PictureCache
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
        self.results, self.summaries = Results(session), Summaries(session)
        self.charts = FigureRows(session)
        self.limits = options.limits
        self._uploads, self._storage = uploads, storage
        chunks = Chunks(session, attempts=options.attempts)
        self._runner = Runner(self.flights, chunks, engine, self._task_of)
        self.pictures = PictureCache(options.pictures, options.keep_picture_bytes)

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
            If the uploads do not go together, or a parameter is wrong.
        LimitError
            If too many flights are queued.
        """
        params_from(order.request["params"])
        check_uploads([self._complete(upload) for upload in order.uploads])
        flight = self.flights.create(order)
        self._runner.wake()
        return flight

    def rerun(self, flight_id: str, change: Callable[[FlightOrder], FlightOrder]) -> FlightRow:
        """Queue a flight of the same uploads beside another one; raises as `order`.

        Parameters
        ----------
        flight_id : str
        change : callable
            Gives the new order for the first one's.
        """
        first = self.flights.get(flight_id, texts=True)
        order = FlightOrder(
            first.name,
            self.flights.uploads(first),
            first.pad,
            first.camera,
            first.request,
            rerun_of=first.id,
        )
        return self.order(replace(change(order), rerun_of=first.id))

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
        self.flights.delete(flight_id)
        self._runner.wake()

    def picture_job(self, flight_id: str, number: int, kind: Kind, folder: Path) -> PictureJob:
        """The job that paints a frame into a folder.

        Raises
        ------
        NotFoundError
            If there is no such flight, or it does not read that frame.
        """
        flight = self.flights.get(flight_id, texts=True)
        chunk = self.results.chunk_of(flight, number)
        return picture_job(flight, chunk, number, kind, folder, self.limits.max_pixels)

    def _task_of(self, flight: FlightRow, chunk: ChunkRow) -> Task:
        if chunk.number:
            return from_rows.frames_task(flight, chunk, self.limits)
        uploads = [self._complete(upload) for upload in self.flights.uploads(flight)]
        files = [(u.id, u.kind or "", u.name, self._uploads.path(u.id)) for u in uploads]
        return from_rows.plan_task(flight, files, self._storage.place, self.limits)

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
    videos = kinds.count("video")
    stills = kinds.count("still") + kinds.count("stills")
    if not videos and not stills:
        raise SpecError(
            "a flight is made of at least one video, still or zip of stills; telemetry alone has "
            "no frames",
            code="mixed_uploads",
        )
    if videos and stills:
        raise SpecError(
            "videos and stills do not go into one flight; make a flight of each",
            code="mixed_uploads",
        )
    if kinds.count("telemetry") > min(1, videos):
        raise SpecError(
            "a flight takes one telemetry file, beside a video; leave the others out",
            code="mixed_uploads",
        )
    if len({upload.id for upload in uploads}) < len(uploads):
        raise SpecError("an upload is named twice; name each once", code="mixed_uploads")
