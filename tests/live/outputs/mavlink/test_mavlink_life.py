"""Heartbeats, ids, silence, age, rate, texts and profiles."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from landing_truth import LandingTruth, report
from mavlink_flight import Flight
from pymavlink.dialects.v20 import common

TRUTH = LandingTruth()


@pytest.fixture
def flight() -> Iterator[Flight]:
    made = Flight()
    made.meet()
    yield made
    made.close()


def _see(flight: Flight, age_s: float = 0.0) -> None:
    taken_s = flight.now.now_s - age_s
    flight.output.take(report(TRUTH.pose(taken_s), taken_s))


def test_a_heartbeat_goes_out_each_second(flight: Flight) -> None:
    flight.end.messages.clear()
    start_s = flight.now.now_s
    flight.pass_time(20.0)
    beats = flight.end.of("HEARTBEAT")
    assert len(beats) == pytest.approx(flight.now.now_s - start_s, abs=1.5)
    for beat in beats:
        assert beat.type == common.MAV_TYPE_ONBOARD_CONTROLLER
        assert beat.autopilot == common.MAV_AUTOPILOT_INVALID
        assert (beat.get_srcSystem(), beat.get_srcComponent()) == (1, 191)
        assert beat.get_msgbuf()[0] == common.PROTOCOL_MARKER_V2


def test_it_speaks_as_a_part_of_the_vehicle_that_it_hears() -> None:
    flight = Flight(system=42, component_id=192)
    flight.meet()
    flight.pass_time(1.5)
    last = flight.end.of("HEARTBEAT")[-1]
    assert (last.get_srcSystem(), last.get_srcComponent()) == (42, 192)
    assert flight.output.stats().system_id == 42
    flight.close()


def test_another_vehicle_is_not_served() -> None:
    flight = Flight(system=7, system_id=3)
    flight.meet()
    flight.pass_time(1.0)
    stats = flight.output.stats()
    assert (stats.autopilot, stats.system_id, stats.profile) == ("none", None, None)
    assert any("other vehicles are heard and not served: 7" in text for text in flight.told)
    assert not flight.end.of("TIMESYNC")
    flight.close()


def test_a_ground_station_is_no_autopilot() -> None:
    flight = Flight(autopilot=common.MAV_AUTOPILOT_INVALID)
    flight.meet()
    assert flight.output.stats().autopilot == "none"
    flight.close()


def test_nothing_is_said_where_nothing_is_seen(flight: Flight) -> None:
    for _ in range(20):
        flight.output.take(report(None, flight.now.now_s))
        flight.now.advance(0.03)
    flight.step()
    assert not flight.end.of("LANDING_TARGET")
    assert flight.output.stats().withheld == {}
    assert flight.sent == []


def test_an_old_pose_is_never_sent(flight: Flight) -> None:
    _see(flight, age_s=0.24)
    _see(flight, age_s=0.26)
    flight.step()
    assert len(flight.end.of("LANDING_TARGET")) == 1
    assert flight.output.stats().withheld == {"too_old": 1}


def test_that_all_poses_are_too_old_is_told_and_told_again(flight: Flight) -> None:
    def told() -> int:
        return sum("taken more than 250 ms ago" in text for text in flight.told)

    for _ in range(40):
        flight.now.advance(0.03)
        _see(flight, age_s=0.4)
        flight.step()
    assert told() == 1
    _see(flight)
    for _ in range(40):
        flight.now.advance(0.03)
        _see(flight, age_s=0.4)
        flight.step()
    assert told() == 2


def test_a_pose_that_becomes_old_while_it_waits_is_not_sent() -> None:
    flight = Flight(autopilot=common.MAV_AUTOPILOT_PX4, truth=TRUTH)
    flight.meet()
    flight.pass_time(2.0)
    taken_s = flight.now.now_s
    flight.stream(taken_s - 0.1)
    flight.step()
    flight.output.take(report(TRUTH.pose(taken_s), taken_s))
    flight.now.advance(0.3)
    flight.stream(taken_s)
    flight.step()
    assert not flight.end.of("LANDING_TARGET")
    assert flight.output.stats().withheld == {"too_old": 1}
    flight.close()


@pytest.mark.parametrize(("frames_hz", "most_hz"), [(30, 20.0), (60, 10.0), (10, 30.0)])
def test_the_rate_is_kept(frames_hz: int, most_hz: float) -> None:
    flight = Flight(max_hz=most_hz)
    flight.meet()
    start_s = flight.now.now_s
    times = []
    for _ in range(frames_hz * 5):
        before = len(flight.sent)
        _see(flight)
        times += [flight.now.now_s] * (len(flight.sent) - before)
        flight.now.advance(1 / frames_hz)
    assert len(times) == pytest.approx(5 * min(frames_hz, most_hz), abs=1)
    within = [np.sum((np.array(times) >= t) & (np.array(times) < t + 1.0)) for t in times]
    assert max(within) <= most_hz + 1
    stats = flight.output.stats()
    assert stats.sent == len(times) == len(flight.end.of("LANDING_TARGET"))
    assert stats.withheld.get("over_rate", 0) == frames_hz * 5 - len(times)
    assert times[0] == start_s
    flight.close()


def test_who_asks_is_told_of_each_pose_that_went(flight: Flight) -> None:
    flight.now.advance(1.0)
    taken_s = flight.now.now_s
    flight.now.advance(0.02)
    one = report(TRUTH.pose(taken_s), taken_s)
    flight.output.take(one)
    assert flight.sent == [(one, flight.now.now_s)]


def test_losing_and_finding_is_told_once_a_second_at_most(flight: Flight) -> None:
    def texts() -> list[tuple[int, str]]:
        return [(m.severity, m.text) for m in flight.end.of("STATUSTEXT")]

    flight.output.sight_changed("found", "")
    assert texts() == [(common.MAV_SEVERITY_INFO, "Pad found")]
    # It comes and goes: the ground station hears how it is after a second.
    for sight in ("lost", "found", "lost", "found", "lost"):
        flight.now.advance(0.1)
        flight.output.sight_changed(sight, "too few cells are in view to tell which they are")
        flight.step()
    assert len(texts()) == 1
    flight.now.advance(0.6)
    flight.step()
    severity, text = texts()[-1]
    assert severity == common.MAV_SEVERITY_WARNING
    assert text == "Pad lost: too few cells are in view to tell which "
    flight.now.advance(5.0)
    flight.output.sight_changed("no_stream", "")
    flight.now.advance(0.5)
    # What it was told of already is not told again.
    flight.output.sight_changed("found", "")
    flight.output.sight_changed("no_stream", "")
    flight.now.advance(2.0)
    flight.step()
    assert [text for _, text in texts()[2:]] == ["No frames from the camera"]


@pytest.mark.parametrize(
    ("autopilot", "profile", "sent_frame", "said"),
    [
        (
            common.MAV_AUTOPILOT_ARDUPILOTMEGA,
            "auto",
            common.MAV_FRAME_BODY_FRD,
            "profile ardupilot",
        ),
        (common.MAV_AUTOPILOT_ARDUPILOTMEGA, "px4", None, "choose ardupilot or auto"),
        (common.MAV_AUTOPILOT_PX4, "ardupilot", common.MAV_FRAME_BODY_FRD, "choose px4 or auto"),
        (common.MAV_AUTOPILOT_GENERIC, "auto", None, "MAV_AUTOPILOT_GENERIC.* is not known"),
        (common.MAV_AUTOPILOT_GENERIC, "ardupilot", common.MAV_FRAME_BODY_FRD, "GENERIC"),
        (77, "auto", None, "MAV_AUTOPILOT 77"),
    ],
)
def test_the_profile_is_the_autopilots_or_it_is_told(
    autopilot: int, profile: Any, sent_frame: int | None, said: str
) -> None:
    flight = Flight(autopilot=autopilot, profile=profile)
    flight.meet()
    _see(flight)
    flight.step()
    frames = [message.frame for message in flight.end.of("LANDING_TARGET")]
    assert frames == ([] if sent_frame is None else [sent_frame])
    assert [text for text in flight.told if re.search(said, text)], flight.told
    flight.close()


def test_without_an_autopilot_nothing_is_guessed() -> None:
    flight = Flight()
    flight.step()
    _see(flight)
    assert flight.output.stats().withheld == {"no_autopilot": 1}
    flight.now.advance(5.0)
    flight.step()
    assert any("no autopilot's heartbeat is heard" in text for text in flight.told)
    flight.close()


def test_an_autopilot_that_falls_silent_is_told_and_taken_up_again(flight: Flight) -> None:
    flight.pass_time(2.0)
    flight.now.advance(6.0)
    flight.step()
    assert flight.output.stats().profile is None
    assert "no autopilot's heartbeat" in flight.told[-1]
    flight.pass_time(0.5)
    assert flight.output.stats().profile == "ardupilot"
    assert sum("profile ardupilot" in text for text in flight.told) == 2


def test_until_the_clock_is_known_times_are_our_own_and_counted(flight: Flight) -> None:
    _see(flight)
    (message,) = flight.end.of("LANDING_TARGET")
    assert message.time_usec == round(flight.now.now_s * 1e6)
    assert flight.output.stats().sent_unsynchronised == 1
    flight.pass_time(3.0)
    assert flight.output.stats().clock.is_known
    _see(flight)
    late = flight.end.of("LANDING_TARGET")[-1]
    assert late.time_usec * 1e-6 == pytest.approx(flight.shows.at(flight.now.now_s), abs=5e-3)
    assert flight.output.stats().sent_unsynchronised == 1


def test_questions_of_an_unknown_clock_are_not_answered(flight: Flight) -> None:
    flight.end.send(common.MAVLink_timesync_message(0, 123))
    flight.step()
    assert not [message for message in flight.end.of("TIMESYNC") if message.tc1]


def test_answers_that_nobody_asked_for_are_left_out(flight: Flight) -> None:
    for k in range(30):
        flight.end.send(common.MAVLink_timesync_message(10**15 + k, 17 + k))
        flight.step()
    assert flight.output.stats().clock.answers == 0


def test_px4_is_asked_for_where_its_vehicle_is_if_it_does_not_say() -> None:
    flight = Flight(autopilot=common.MAV_AUTOPILOT_PX4)
    flight.meet()
    flight.pass_time(4.0)
    asked = {(m.command, m.param1, m.target_system) for m in flight.end.of("COMMAND_LONG")}
    assert asked == {
        (common.MAV_CMD_SET_MESSAGE_INTERVAL, common.MAVLINK_MSG_ID_LOCAL_POSITION_NED, 1),
        (common.MAV_CMD_SET_MESSAGE_INTERVAL, common.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, 1),
    }
    flight.close()


def test_what_keeps_poses_from_px4_is_told_by_name() -> None:
    flight = Flight(autopilot=common.MAV_AUTOPILOT_PX4)
    flight.meet()
    said = []
    for send in (lambda: None, lambda: None, lambda: flight.stream(flight.now.now_s - 2)):
        send()
        _see(flight)
        flight.step()
        said.append([text for text in flight.told if "were not sent" in text][-1])
        flight.pass_time(2.0)
    assert "its clock is not known yet" in said[0]
    assert "no LOCAL_POSITION_NED and no ATTITUDE_QUATERNION or ATTITUDE" in said[1]
    assert "too seldom or too late" in said[2]
    flight.close()


def test_px4_is_asked_for_what_comes_too_seldom() -> None:
    # As on a link to a ground station: attitudes often, positions once a second.
    flight = Flight(autopilot=common.MAV_AUTOPILOT_PX4)
    flight.meet()
    for k in range(40):
        boot_ms = round(flight.shows.at(flight.now.now_s) * 1e3)
        flight.end.send(common.MAVLink_attitude_message(boot_ms, *[0.0] * 6))
        if k % 10 == 0:
            flight.end.send(common.MAVLink_local_position_ned_message(boot_ms, *[0.0] * 6))
        flight.pass_time(0.1)
    asked = {message.param1 for message in flight.end.of("COMMAND_LONG")}
    assert asked == {common.MAVLINK_MSG_ID_LOCAL_POSITION_NED}
    flight.close()


def test_where_it_says_so_it_is_not_asked(flight: Flight) -> None:
    # ArduPilot's profile needs nothing of it.
    flight.pass_time(4.0)
    assert not flight.end.of("COMMAND_LONG")
    other = Flight(autopilot=common.MAV_AUTOPILOT_PX4)
    other.meet()
    for _ in range(8):
        other.stream(other.now.now_s)
        other.pass_time(0.5)
    assert not other.end.of("COMMAND_LONG")
    other.close()
