"""Callbacks are signed, tried again, over restarts too, and made once."""

from __future__ import annotations

import base64
import hashlib
import hmac
import socket
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import flight_orders
import pytest
import tls_certificate
import videos
from callback_receiver import Receiver, receiving
from sqlalchemy import update

from padstudio.flights.callbacks import Callbacks
from padstudio.flights.chunks import Chunks
from padstudio.flights.jobs import FlightOrder, Flights
from padstudio.store.database.flight_tables import CallbackRow, FlightRow
from padstudio.store.store import Store
from padstudio.web.server.callbacks.hosts import CallbackHosts
from padstudio.web.server.callbacks.service import CallbackService

NewDatabase = Callable[[], str | None]
SECRET = "a secret of many letters"
ERROR = {"code": "damaged", "message": "the file is damaged", "detail": {}}


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as found:
        yield found


class Office:
    """A store with one upload, its flights, and who is called."""

    def __init__(self, folder: Path, database_url: str | None = None) -> None:
        self.folder, self.url = folder, database_url
        self.open()
        self.upload = flight_orders.upload(self.store, videos.write(folder / "a.mp4", 2))

    def open(self) -> None:
        self.store = Store(self.folder / "data", self.url)
        self.flights = Flights(self.store.session)
        self.callbacks = Callbacks(self.store.session)

    def order(self, url: str) -> FlightRow:
        order = flight_orders.order(self.upload)
        return self.flights.create(FlightOrder(**vars(order) | {"callback": url}))

    def service(self, receiver: Receiver, **options: Any) -> CallbackService:
        hosts = CallbackHosts([receiver.host])
        return CallbackService(self.callbacks, hosts, SECRET, **({"waits_s": (0.0,) * 3} | options))

    def of(self, flight: FlightRow) -> CallbackRow:
        found = self.callbacks.of(flight)
        assert found is not None
        return found


@pytest.fixture
def office(tmp_path: Path) -> Iterator[Office]:
    made = Office(tmp_path)
    yield made
    made.store.close()


def test_a_callback_is_made_once_when_its_flight_has_ended(
    office: Office, receiver: Receiver
) -> None:
    flight, service = office.order(receiver.url), office.service(receiver)
    assert service.make_due() == 0
    office.flights.cancel(flight.id)
    assert [service.make_due() for _ in range(3)] == [1, 0, 0]
    [(path, headers, body)] = receiver.calls
    row = office.of(flight)
    assert (path, row.state, row.attempts, row.error) == ("/hook?job=7", "delivered", 1, None)
    assert headers["webhook-id"] == row.delivery
    assert headers["host"] == receiver.host
    [told] = receiver.bodies()
    assert (told["type"], told["data"]["id"], told["data"]["state"]) == (
        "flight.cancelled",
        flight.id,
        "cancelled",
    )
    assert told["data"]["links"]["poses"] == f"/api/v1/flights/{flight.id}/export/jsonl"
    signed = f"{headers['webhook-id']}.{headers['webhook-timestamp']}.".encode() + body
    digest = hmac.new(SECRET.encode(), signed, hashlib.sha256).digest()
    assert headers["webhook-signature"] == f"v1,{base64.b64encode(digest).decode()}"
    age_s = datetime.now(UTC).timestamp() - int(headers["webhook-timestamp"])
    assert -1 < age_s < 60


def test_it_is_tried_again_until_it_is_taken(office: Office, receiver: Receiver) -> None:
    flight, service = office.order(receiver.url), office.service(receiver)
    office.flights.cancel(flight.id)
    receiver.answers += [500, 302]
    for attempts, error in ((1, "status 500"), (2, "status 302")):
        assert service.make_due() == 1
        row = office.of(flight)
        assert (row.state, row.attempts) == ("open", attempts)
        assert error in (row.error or "")
    assert service.make_due() == 1
    assert service.make_due() == 0
    assert office.of(flight).state == "delivered"
    assert len({headers["webhook-id"] for _, headers, _ in receiver.calls}) == 1
    assert {path for path, _, _ in receiver.calls} == {"/hook?job=7"}, "a redirect was followed"


def test_it_is_given_up_after_the_last_wait(office: Office, receiver: Receiver) -> None:
    flight, service = office.order(receiver.url), office.service(receiver)
    office.flights.cancel(flight.id)
    receiver.answers += [503] * 9
    assert [service.make_due() for _ in range(6)] == [1, 1, 1, 1, 0, 0]
    row = office.of(flight)
    assert (row.state, row.attempts, row.next_at) == ("given_up", 4, None)


def test_waits_grow_and_are_kept_over_a_restart(office: Office, receiver: Receiver) -> None:
    flight = office.order(receiver.url)
    office.flights.cancel(flight.id)
    receiver.answers += [500]
    waits_s = (100.0, 1000.0)
    assert office.service(receiver, waits_s=waits_s).make_due() == 1
    office.store.close()
    office.open()
    next_at = office.of(flight).next_at
    assert next_at is not None
    assert 90 < (next_at - datetime.now(UTC)).total_seconds() <= 100
    assert office.service(receiver, waits_s=waits_s).make_due() == 0
    with office.store.session.begin() as session:
        session.execute(update(CallbackRow).values(next_at=datetime.now(UTC) - timedelta(1)))
    assert office.service(receiver, waits_s=waits_s).make_due() == 1
    assert office.of(flight).state == "delivered"
    assert receiver.calls[0][1]["webhook-id"] == receiver.calls[1][1]["webhook-id"]


def test_who_does_not_answer_keeps_no_server_from_ending(office: Office) -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        receiver = Receiver(silent.getsockname()[1])
        flight, service = office.order(receiver.url), office.service(receiver)
        office.flights.cancel(flight.id)
        service.start()
        connection, _ = silent.accept()
        service.close()
        # It still waits for an answer.
        connection.setblocking(False)
        assert connection.recv(100).startswith(b"POST /hook")
        assert (office.of(flight).state, office.of(flight).attempts) == ("open", 1)
        connection.close()


def test_a_server_that_ended_in_the_middle_of_one_makes_it_again(
    office: Office, receiver: Receiver
) -> None:
    flight = office.order(receiver.url)
    office.flights.cancel(flight.id)
    [due] = office.callbacks.due(9)
    assert office.callbacks.begin(due, 0.0)
    assert not office.callbacks.begin(due, 0.0), "somebody else made the same attempt"
    assert office.service(receiver).make_due() == 1
    assert (office.of(flight).state, office.of(flight).attempts) == ("delivered", 2)


def test_a_failed_flight_calls_and_calls_again_after_a_retry(
    office: Office, receiver: Receiver
) -> None:
    flight, service = office.order(receiver.url), office.service(receiver)
    chunks = Chunks(office.store.session)
    [claim] = chunks.claim(1)
    chunks.fail(claim, ERROR)
    service.make_due()
    office.flights.retry(flight.id)
    assert service.make_due() == 0
    office.flights.cancel(flight.id)
    service.make_due()
    assert [told["type"] for told in receiver.bodies()] == ["flight.failed", "flight.cancelled"]
    assert receiver.bodies()[0]["data"]["error"]["code"] == "damaged"
    assert len({headers["webhook-id"] for _, headers, _ in receiver.calls}) == 2


def test_a_host_that_is_listed_no_longer_is_not_called(office: Office, receiver: Receiver) -> None:
    flight = office.order(receiver.url)
    office.flights.cancel(flight.id)
    CallbackService(office.callbacks, CallbackHosts([]), SECRET).make_due()
    assert "does not call" in (office.of(flight).error or "")
    assert not receiver.calls


def test_the_address_that_was_looked_at_is_the_one_that_is_called(
    office: Office, receiver: Receiver
) -> None:
    url = f"http://hooks.example:{receiver.port}/"
    flight = office.order(url)
    office.flights.cancel(flight.id)
    asked = []

    def resolve(host: str, port: int) -> str:
        asked.append((host, port))
        return "127.0.0.1"

    hosts = CallbackHosts([f"hooks.example:{receiver.port}"])
    CallbackService(office.callbacks, hosts, SECRET, resolve_host=resolve).make_due()
    assert asked == [("hooks.example", receiver.port)]
    assert receiver.calls[0][1]["host"] == f"hooks.example:{receiver.port}"


def test_tls_is_verified_for_the_name_though_the_address_is_called(
    office: Office, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate = tls_certificate.write(tmp_path, "hooks.example")
    monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
    with receiving(certificate) as safe:
        names = ("hooks.example", "other.example")
        hosts = CallbackHosts([f"{name}:{safe.port}" for name in names])
        rows = []
        for name in names:
            flight = office.order(f"https://{name}:{safe.port}/")
            office.flights.cancel(flight.id)
            CallbackService(
                office.callbacks, hosts, SECRET, resolve_host=lambda *_: "127.0.0.1"
            ).make_due()
            rows.append(office.of(flight))
    assert [row.state for row in rows] == ["delivered", "open"]
    assert rows[1].error == "other.example cannot be reached: ConnectError"
    assert len(safe.calls) == 1


def test_a_host_that_is_away_is_told_and_tried_again(office: Office) -> None:
    with receiving() as gone:
        flight = office.order(gone.url)
    office.flights.cancel(flight.id)
    office.service(gone).make_due()
    row = office.of(flight)
    assert (row.state, row.error) == ("open", "127.0.0.1 cannot be reached: ConnectError")


def test_the_callback_goes_with_its_flight(office: Office, receiver: Receiver) -> None:
    flight, service = office.order(receiver.url), office.service(receiver)
    office.flights.cancel(flight.id)
    office.flights.delete(flight.id)
    assert service.make_due() == 0
    while office.flights.purge():
        pass
    assert office.callbacks.of(flight) is None


def test_on_every_database(tmp_path: Path, new_database: NewDatabase, receiver: Receiver) -> None:
    office = Office(tmp_path, new_database())
    flight = office.order(receiver.url)
    office.flights.cancel(flight.id)
    receiver.answers += [500]
    assert [office.service(receiver).make_due() for _ in range(3)] == [1, 1, 0]
    assert office.of(flight).state == "delivered"
    office.store.close()
