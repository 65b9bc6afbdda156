"""Sends poses to an autopilot as they are known, and never an old one."""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, cast

from padstudio.live.outputs.mavlink import messages
from padstudio.live.outputs.mavlink.compose import message_of, needs_track, profile_of
from padstudio.live.outputs.mavlink.link import Arrived, Link
from padstudio.live.outputs.mavlink.notices import Notices
from padstudio.live.outputs.mavlink.peer import Peer
from padstudio.live.outputs.mavlink.settings import MavlinkSettings
from padstudio.live.outputs.mavlink.stats import MavlinkStats, Withheld
from padstudio.live.reports.report import LiveReport
from padstudio.live.reports.report import Sight as SightState

logger = logging.getLogger(__name__)

_WAIT_S, _CLOSED_WAIT_S = 0.05, 0.1
# A name that nobody knows may take the thread long to ask for.
_CLOSING_S = 3.0
_HEARTBEAT_S, _TEXT_S = 1.0, 1.0
# Poses that wait for the vehicle's: as many as come in between two of its messages.
_MOST_WAITING = 16

Sent = Callable[[LiveReport, float], None]
Tell = Callable[[str], None]


class MavlinkOutput:
    """An `Output` to one autopilot.

    Parameters
    ----------
    settings : MavlinkSettings
    sent : callable, optional
        Told each report that was sent and when, of `time.monotonic`, in the thread that sent it.
    tell : callable, optional
        Told sentences on the link and the autopilot when they change.
    now : callable
        Time of `time.monotonic`, s.
    """

    def __init__(
        self,
        settings: MavlinkSettings,
        *,
        sent: Sent = lambda report, sent_s: None,
        tell: Tell = lambda text: None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._settings, self._sent, self._tell, self._now = settings, sent, tell, now
        self._link = Link(
            settings.address,
            component_id=settings.component_id,
            signing_key=settings.signing_key,
            now=now,
        )
        self._link.speak_as(settings.system_id or 1)
        self._peer = Peer(settings.system_id)
        self._lock = threading.RLock()
        self._waiting: deque[LiveReport] = deque()
        self._withheld: Counter[Withheld] = Counter()
        self._poses = self._unsynchronised = 0
        self._due_s = self._heartbeat_s = self._text_s = now()
        self._text: tuple[SightState, str] | None = None
        self._said: SightState | None = None
        self._notices = Notices(settings, now())
        self._ending = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> MavlinkOutput:
        """Begin to listen and to send heartbeats, in a thread of its own."""
        self._thread = threading.Thread(target=self._run, name="mavlink", daemon=True)
        self._thread.start()
        return self

    def take(self, report: LiveReport) -> None:
        """Send a pose, if there is one; where nothing is seen nothing is said."""
        if report.detection.pose is None:
            return
        went: list[tuple[LiveReport, float]] = []
        with self._lock:
            now_s = self._now()
            if self._is_old(report, now_s):
                self._withheld["too_old"] += 1
            elif now_s < self._due_s:
                self._withheld["over_rate"] += 1
            else:
                # Late frames do not slow down those that follow, nor let them come in a crowd.
                period_s = 1 / self._settings.max_hz
                self._due_s = max(self._due_s, now_s - period_s) + period_s
                self._waiting.append(report)
                went += self._send_waiting(now_s)
        self._report(went)

    def sight_changed(self, sight: SightState, detail: str) -> None:
        """Tell the autopilot, and so the ground station, once a second at most."""
        with self._lock:
            self._text = (sight, detail)
            self._say(self._now())

    def close(self) -> None:
        """End the thread and the link."""
        self._ending.set()
        if self._thread is not None:
            self._thread.join(_CLOSING_S)
        self._link.close()

    def stats(self) -> MavlinkStats:
        """What became of the poses so far; from any thread."""
        with self._lock:
            now_s = self._now()
            heard = self._peer.is_heard(now_s)
            return MavlinkStats(
                address=str(self._settings.address),
                is_open=self._link.is_open,
                detail=self._link.detail,
                autopilot=self._peer.name if heard else "none",
                system_id=self._peer.ids[0] if heard and self._peer.ids else None,
                profile=profile_of(self._settings, self._peer, now_s),
                sent=self._poses,
                sent_unsynchronised=self._unsynchronised,
                withheld=dict(self._withheld),
                link=replace(self._link.counts),
                clock=self._peer.clock.state(now_s),
            )

    def step(self, wait_s: float = 0.0) -> None:
        """Take what has come, and send what is due; waits for messages at most so long."""
        arrived = self._link.step(wait_s)
        with self._lock:
            for item in arrived:
                self._hear(item)
            now_s = self._now()
            went = list(self._send_waiting(now_s))
            if self._link.is_open:
                self._send_due(now_s)
            counts = self._poses, self._withheld
            news = self._notices.changes(self._link, self._peer, now_s, *counts)
        self._report(went)
        for text in news:
            self._tell(text)

    def _run(self) -> None:
        is_told = False
        while not self._ending.is_set():
            try:
                self.step(_WAIT_S)
            except Exception as error:
                # Heartbeats and poses go on, whatever one message or a listener brings to light.
                if not is_told:
                    logger.exception("MAVLink goes on after a defect", exc_info=error)
                is_told = True
                self._ending.wait(_CLOSED_WAIT_S)
            if not self._link.is_open:
                self._ending.wait(_CLOSED_WAIT_S)

    def _report(self, went: list[tuple[LiveReport, float]]) -> None:
        # Not under the lock: who is told may ask for the figures.
        for report, sent_s in went:
            self._sent(report, sent_s)

    def _send_due(self, now_s: float) -> None:
        if now_s >= self._heartbeat_s:
            self._heartbeat_s = max(self._heartbeat_s, now_s - _HEARTBEAT_S) + _HEARTBEAT_S
            self._link.send(messages.heartbeat())
        with_track = needs_track(self._settings, profile_of(self._settings, self._peer, now_s))
        for question in self._peer.questions(now_s, needs_track=with_track):
            self._link.send(question)
        self._say(now_s)

    def _hear(self, item: Arrived) -> None:
        message = item.message
        answer = self._peer.take(message, item.time_s)
        ids = self._peer.ids
        if ids is not None and ids == (message.get_srcSystem(), message.get_srcComponent()):
            self._link.answer_to(item.source)
            self._link.speak_as(ids[0])
        if answer is not None:
            self._link.send(answer)

    def _is_old(self, report: LiveReport, now_s: float) -> bool:
        return now_s - report.frame.taken_s > self._settings.max_age_s

    def _send_waiting(self, now_s: float) -> Iterator[tuple[LiveReport, float]]:
        """Send poses in their order, up to the first that still waits for the vehicle's."""
        profile = profile_of(self._settings, self._peer, now_s)
        while self._waiting:
            report = self._waiting[0]
            made: Any | Withheld | None = "too_old"
            if not self._is_old(report, now_s):
                made = message_of(report, self._settings, self._peer, profile)
            if made is None and len(self._waiting) <= _MOST_WAITING:
                return
            self._waiting.popleft()
            if made is None or isinstance(made, str):
                self._withheld[cast("Withheld", made or "no_vehicle_pose")] += 1
            elif self._link.send(made):
                self._poses += 1
                self._unsynchronised += self._peer.clock.at_ns(now_s) is None
                yield report, self._now()
            else:
                self._withheld["link"] += 1

    def _say(self, now_s: float) -> None:
        if self._text is None or now_s < self._text_s:
            return
        sight, detail = self._text
        if sight == self._said:
            self._text = None
        else:
            self._text_s = now_s + _TEXT_S
            if self._link.send(messages.sight_text(sight, detail)):
                self._text, self._said = None, sight
