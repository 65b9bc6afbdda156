"""Links over UDP, TCP and a terminal: lost and found, garbage, signatures, faults by name."""

from __future__ import annotations

import contextlib
import os
import socket
import threading
import time
import tty
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from autopilot_end import AutopilotEnd, ManualClock, stream_end, udp_end, until
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from landing_truth import LandingTruth, report
from mavlink_flight import Flight
from pymavlink.dialects.v20 import common

from padstudio.errors import SpecError
from padstudio.live.outputs.mavlink.address import Address, parse_address
from padstudio.live.outputs.mavlink.output import MavlinkOutput
from padstudio.live.outputs.mavlink.settings import MavlinkSettings, read_signing_key

TRUTH = LandingTruth()
KEY = bytes(range(32))


def _output(address: str, now: Any, told: list[str], **options: Any) -> MavlinkOutput:
    made = MavlinkSettings(address=parse_address(address), **options)
    return MavlinkOutput(made, tell=told.append, now=now)


def _target_arrives(output: MavlinkOutput, end: AutopilotEnd, now: ManualClock) -> None:
    """From the first heartbeat to a pose that comes out at the other end."""
    end.heartbeat()
    until(lambda: output.stats().autopilot != "none", lambda: output.step(0.01))
    end.messages.clear()
    now.advance(0.1)
    output.take(report(TRUTH.pose(now.now_s), now.now_s))
    (message,) = until(lambda: end.of("LANDING_TARGET"), lambda: output.step(0.01))
    assert message.frame == common.MAV_FRAME_BODY_FRD


def test_a_server_speaks_to_the_autopilot_that_sends_to_it() -> None:
    now, told = ManualClock(), []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    output = _output(f"udpin:127.0.0.1:{port}", now, told)
    output.step()
    # A pose before anybody is heard goes nowhere, and that is counted.
    output.take(report(TRUTH.pose(now.now_s), now.now_s))
    assert output.stats().sent == 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as place:
        place.connect(("127.0.0.1", port))
        end = stream_end(place.fileno())
        _target_arrives(output, end, now)
    output.close()


def test_a_server_answers_the_autopilot_and_not_who_spoke_last() -> None:
    now = ManualClock()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    output = _output(f"udpin:127.0.0.1:{port}", now, [])
    output.step()
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station,
    ):
        vehicle.connect(("127.0.0.1", port))
        station.connect(("127.0.0.1", port))
        autopilot = stream_end(vehicle.fileno())
        other = stream_end(station.fileno(), autopilot=common.MAV_AUTOPILOT_INVALID, system=255)
        other.heartbeat()
        autopilot.heartbeat()
        other.heartbeat()
        until(lambda: output.stats().link.received == 3, lambda: output.step(0.01))
        now.advance(2.0)
        until(lambda: autopilot.of("HEARTBEAT"), lambda: output.step(0.01))
        assert not other.of("HEARTBEAT")
    output.close()


class TcpServer:
    """Where an autopilot is that comes and goes."""

    def __init__(self) -> None:
        self.port = 0
        self.open()

    def open(self) -> None:
        self.listener = socket.create_server(("127.0.0.1", self.port))
        self.port = self.listener.getsockname()[1]

    def accept(self) -> AutopilotEnd:
        self.connection, _ = self.listener.accept()
        return stream_end(self.connection.fileno())

    def close(self) -> None:
        self.listener.close()
        with contextlib.suppress(AttributeError):
            self.connection.close()


def test_what_a_silent_server_does_not_take_is_not_kept_for_later() -> None:
    server, now = TcpServer(), ManualClock()
    output = _output(f"tcp:127.0.0.1:{server.port}", now, [], profile="ardupilot", max_hz=1000.0)
    output.step()
    end = server.accept()
    server.connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2304)
    for _ in range(20000):
        now.advance(0.01)
        output.take(report(TRUTH.pose(0.0), now.now_s))
        if output.stats().withheld.get("link", 0) > 10:
            break
    stats = output.stats()
    assert stats.withheld["link"] > 10
    until(lambda: len(end.of("LANDING_TARGET")) == stats.sent, lambda: output.step(0.01))
    assert end.bad == 0
    output.close()
    server.close()


def test_an_autopilot_behind_tcp_goes_and_returns() -> None:
    server, now, told = TcpServer(), ManualClock(), []
    output = _output(f"tcp:127.0.0.1:{server.port}", now, told)
    output.step()
    _target_arrives(output, server.accept(), now)

    server.close()
    until(lambda: not output.stats().is_open, lambda: output.step(0.01))
    assert "trying again" in output.stats().detail
    now.advance(0.1)
    output.take(report(TRUTH.pose(now.now_s), now.now_s))
    assert output.stats().withheld == {"link": 1}
    # While nobody is there it is tried in growing pauses, and poses are not kept.
    for _ in range(8):
        now.advance(1.0)
        output.step()
    assert not output.stats().is_open

    server.open()
    now.advance(5.0)
    output.step()
    _target_arrives(output, server.accept(), now)
    stats = output.stats()
    assert (stats.link.opened, stats.sent) == (2, 2)
    assert [text.endswith(": open") for text in told if str(server.port) in text].count(True) == 2
    output.close()
    server.close()


@pytest.fixture
def terminal() -> Iterator[tuple[int, str]]:
    ours, theirs = os.openpty()
    tty.setraw(ours)
    name = os.ttyname(theirs)
    os.close(theirs)
    yield ours, name
    with contextlib.suppress(OSError):
        os.close(ours)


def test_a_serial_port(terminal: tuple[int, str]) -> None:
    descriptor, name = terminal
    now, told = ManualClock(), []
    output = _output(f"serial:{name}:921600", now, told)
    output.step()
    _target_arrives(output, stream_end(descriptor), now)
    # It is ours alone meanwhile.
    other = _output(f"serial:{name}:921600", now, told)
    other.step()
    assert "busy" in other.stats().detail
    other.close()
    # Unplugged.
    os.close(descriptor)
    until(lambda: not output.stats().is_open, lambda: output.step(0.01))
    output.close()


def test_what_nobody_takes_is_dropped_and_counted(terminal: tuple[int, str]) -> None:
    descriptor, name = terminal
    now = ManualClock()
    output = _output(f"serial:{name}:57600", now, [], profile="ardupilot", max_hz=1000.0)
    output.step()
    for _ in range(3000):
        now.advance(0.01)
        output.take(report(TRUTH.pose(0.0), now.now_s))
        if output.stats().withheld.get("link", 0) > 10:
            break
    stats = output.stats()
    assert stats.withheld["link"] > 10
    # What did go is whole.
    end = stream_end(descriptor)
    until(lambda: len(end.of("LANDING_TARGET")) == stats.sent, lambda: output.step(0.01))
    assert end.bad == 0
    output.close()


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("serial:/dev/no-such-port:57600", "serial port /dev/no-such-port is not there"),
        ("serial:{file}:57600", "is no serial port"),
        ("serial:{terminal}:12345", "a baud rate of 12345 is not known"),
        ("tcp:127.0.0.1:{closed}", "refused"),
        ("udpin:127.0.0.1:{taken}", "in use"),
        ("udpout:no-such-host.invalid:14550", "no-such-host.invalid"),
    ],
)
def test_what_is_wrong_is_told_by_name(
    address: str, said: str, tmp_path: Path, terminal: tuple[int, str]
) -> None:
    (tmp_path / "file").write_text("no port")
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken,
        socket.socket(socket.AF_INET, socket.SOCK_STREAM) as closed,
    ):
        taken.bind(("127.0.0.1", 0))
        closed.bind(("127.0.0.1", 0))
        told: list[str] = []
        text = address.format(
            file=tmp_path / "file",
            terminal=terminal[1],
            taken=taken.getsockname()[1],
            closed=closed.getsockname()[1],
        )
        output = _output(text, ManualClock(), told)
        output.step()
        assert len(told) == 1
        assert said in told[0]
        assert said in output.stats().detail
        output.close()


def test_garbage_between_messages_is_counted_and_does_no_harm() -> None:
    flight = Flight()
    flight.meet()
    random = np.random.default_rng(2)
    for _ in range(50):
        # Beginnings of packets that never go on are among them.
        flight.end.send_bytes(b"\xfd" * 3 + random.bytes(int(random.integers(1, 300))))
        flight.end.heartbeat()
        flight.step()
    stats = flight.output.stats()
    assert stats.link.garbage >= 50
    # A datagram that is damaged does not spoil the next one.
    assert stats.link.received >= 51
    assert stats.autopilot == "MAV_AUTOPILOT_ARDUPILOTMEGA"
    flight.close()


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.binary(min_size=1, max_size=400), min_size=1, max_size=6))
def test_no_bytes_end_it(pieces: list[bytes]) -> None:
    flight = Flight()
    flight.meet()
    for piece in pieces:
        flight.end.send_bytes(piece)
        flight.step()
    flight.end.heartbeat()
    flight.step()
    assert flight.output.stats().autopilot == "MAV_AUTOPILOT_ARDUPILOTMEGA"
    flight.close()


def test_garbage_on_a_stream_of_bytes_does_no_harm() -> None:
    server, now, told = TcpServer(), ManualClock(), []
    output = _output(f"tcp:127.0.0.1:{server.port}", now, told)
    output.step()
    end = server.accept()
    for _ in range(20):
        end.send_bytes(b"\x00noise\xff" * 40)
        end.heartbeat()
    _target_arrives(output, end, now)
    assert output.stats().link.garbage > 0
    output.close()
    server.close()


def test_with_a_key_both_ends_sign() -> None:
    flight = Flight(key=KEY)
    flight.meet()
    flight.pass_time(2.0)
    assert flight.output.stats().clock.is_known
    flight.output.take(report(TRUTH.pose(0.0), flight.now.now_s))
    (message,) = flight.end.of("LANDING_TARGET")
    assert message.get_signed()
    assert flight.end.bad == 0
    flight.close()


def test_an_autopilot_with_another_key_is_not_believed() -> None:
    flight = Flight(key=KEY)
    flight.end.packer.signing.secret_key = KEY[::-1]
    flight.meet()
    assert flight.output.stats().autopilot == "none"
    flight.end.packer.signing.sign_outgoing = False
    flight.meet()
    assert flight.output.stats().autopilot == "none"
    assert flight.output.stats().link.garbage == 2
    flight.close()


def test_without_a_key_signed_messages_are_read() -> None:
    flight = Flight()
    flight.end.packer.signing.secret_key = KEY
    flight.end.packer.signing.sign_outgoing = True
    flight.meet()
    flight.pass_time(2.0)
    assert flight.output.stats().clock.is_known
    flight.close()


def test_keys_are_read_from_files(tmp_path: Path) -> None:
    (tmp_path / "raw").write_bytes(KEY)
    (tmp_path / "digits").write_text(KEY.hex() + "\n")
    (tmp_path / "other").write_text("open sesame")
    assert read_signing_key(tmp_path / "raw") == KEY
    assert read_signing_key(tmp_path / "digits") == KEY
    with pytest.raises(SpecError) as caught:
        read_signing_key(tmp_path / "other")
    assert "sesame" not in caught.value.message


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("udpout:192.168.1.2:14550", Address("udpout", "192.168.1.2", 14550)),
        ("udpin:0.0.0.0:14550", Address("udpin", "0.0.0.0", 14550)),
        ("udpin:[::1]:14550", Address("udpin", "::1", 14550)),
        ("tcp:autopilot.local:5760", Address("tcp", "autopilot.local", 5760)),
        ("serial:/dev/ttyACM0:115200", Address("serial", "/dev/ttyACM0", 115200)),
        (
            "serial:/dev/serial/by-id/usb-a:b:57600",
            Address("serial", "/dev/serial/by-id/usb-a:b", 57600),
        ),
    ],
)
def test_addresses_are_read(text: str, address: Address) -> None:
    assert parse_address(text) == address
    assert str(address) == text


@pytest.mark.parametrize(
    "text",
    ["", "udp:127.0.0.1:14550", "udpin:14550", "tcp:host:0", "tcp:host:70000", "tcp:a:b:1"]
    + ["serial:/dev/ttyUSB0", "serial::57600", "udpout:host:14550 ", "/dev/ttyUSB0"],
)
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(SpecError, match="MAVLink address") as caught:
        parse_address(text)
    assert caught.value.error_code == "invalid_mavlink_address"


@pytest.mark.parametrize(
    "wrong",
    [{"system_id": 0}, {"component_id": 256}, {"max_hz": 0.0}, {"max_age_s": -1.0}]
    + [{"signing_key": b"short"}, {"target_number": 300}, {"max_hz": float("nan")}],
)
def test_settings_out_of_range_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(SpecError):
        MavlinkSettings(address=parse_address("tcp:a:1"), **wrong)


def test_in_a_thread_of_its_own_it_beats_until_it_is_closed() -> None:
    end, port, place = udp_end()
    made = MavlinkSettings(address=parse_address(f"udpout:127.0.0.1:{port}"))
    output = MavlinkOutput(made).start()
    try:
        until(lambda: end.of("HEARTBEAT"), lambda: None)
        end.heartbeat()
        until(lambda: end.of("TIMESYNC"), lambda: None)
    finally:
        output.close()
        place.close()
    assert not [thread for thread in threading.enumerate() if thread.name == "mavlink"]


def test_a_listener_that_fails_does_not_end_it() -> None:
    def fail(text: str) -> None:
        raise BrokenPipeError(text)

    end, port, place = udp_end()
    made = MavlinkSettings(address=parse_address(f"udpout:127.0.0.1:{port}"))
    output = MavlinkOutput(made, tell=fail).start()
    try:
        until(lambda: end.of("HEARTBEAT"), lambda: None)
        end.heartbeat()
        until(lambda: end.of("TIMESYNC"), lambda: None)
        until(lambda: len(end.of("HEARTBEAT")) > 1, lambda: None)
    finally:
        output.close()
        place.close()


def test_two_threads_send_whole_packets_in_their_order() -> None:
    end, port, place = udp_end()
    made = MavlinkSettings(
        address=parse_address(f"udpout:127.0.0.1:{port}"), profile="ardupilot", max_hz=1000.0
    )
    output = MavlinkOutput(made).start()
    try:
        until(lambda: end.of("HEARTBEAT"), lambda: None)
        for k in range(1000):
            # Questions and answers go out in the one thread meanwhile, poses in this one.
            end.send(common.MAVLink_timesync_message(0, k + 1))
            if k % 50 == 0:
                end.heartbeat()
            output.take(report(TRUTH.pose(0.0), time.monotonic()))
            end.read()
        sent = output.stats().sent
        until(lambda: len(end.of("LANDING_TARGET")) >= sent, lambda: None)
    finally:
        output.close()
        place.close()
    assert sent > 100
    assert end.bad == 0
    numbers = np.array([message.get_seq() for message in end.messages])
    assert set(np.diff(numbers) % 256) == {1}
