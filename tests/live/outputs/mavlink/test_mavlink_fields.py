"""Every field of both profiles against a landing whose transforms are known."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from export_records import rotation
from landing_truth import LandingTruth, report
from mavlink_flight import Flight
from pymavlink.dialects.v20 import common

from padstudio.autopilot.vehicle import Mount

TRUTH = LandingTruth(30.0, 0.2, [0.12, -0.05, 0.08])
MOUNT = Mount(TRUTH.T_body_camera[:3, :3], TRUTH.T_body_camera[:3, 3])
PAD_MM = (400.0, 300.0)
# Of a report that is sent at once.
TAKEN_BEFORE_S = 0.04


def _flight(autopilot: int, **settings: object) -> Flight:
    flight = Flight(autopilot=autopilot, truth=TRUTH, mount=MOUNT, pad_size_mm=PAD_MM, **settings)
    flight.meet()
    flight.pass_time(8.0)
    return flight


@pytest.fixture(scope="module")
def ardupilot() -> Iterator[Flight]:
    flight = _flight(common.MAV_AUTOPILOT_ARDUPILOTMEGA, target_number=3)
    yield flight
    flight.close()


@pytest.fixture(scope="module")
def px4() -> Iterator[Flight]:
    flight = _flight(common.MAV_AUTOPILOT_PX4)
    yield flight
    flight.close()


def _sent(flight: Flight, **options: float) -> tuple[float, object]:
    """Take a frame now; gives its time and the one message that says it."""
    taken_s = flight.now.now_s
    flight.now.advance(TAKEN_BEFORE_S)
    flight.end.messages.clear()
    flight.output.take(report(TRUTH.pose(taken_s), taken_s, **options))
    (message,) = flight.end.of("LANDING_TARGET")
    return taken_s, message


def _check_picture(message: object, taken_s: float) -> None:
    T = np.linalg.inv(TRUTH.T_body_camera) @ TRUTH.pad_in_body(taken_s)
    right, down, ahead = T[:3, 3]
    assert message.angle_x == pytest.approx(math.atan2(right, ahead), abs=1e-6)
    assert message.angle_y == pytest.approx(math.atan2(down, ahead), abs=1e-6)
    distance = np.linalg.norm(TRUTH.pad_in_body(taken_s)[:3, 3])
    assert message.distance == pytest.approx(distance, rel=1e-6)
    assert message.size_x == pytest.approx(2 * math.atan(0.2 / distance), rel=1e-6)
    assert message.size_y == pytest.approx(2 * math.atan(0.15 / distance), rel=1e-6)
    assert message.type == common.LANDING_TARGET_TYPE_VISION_FIDUCIAL
    assert message.position_valid == 1
    assert (message.get_srcSystem(), message.get_srcComponent()) == (1, 191)


def test_ardupilot_reads_the_pad_in_its_body_frame(ardupilot: Flight) -> None:
    for _ in range(10):
        taken_s, message = _sent(ardupilot)
        _check_picture(message, taken_s)
        assert (message.frame, message.target_num) == (common.MAV_FRAME_BODY_FRD, 3)
        T = TRUTH.pad_in_body(taken_s)
        assert [message.x, message.y, message.z] == pytest.approx(T[:3, 3], abs=1e-5)
        assert rotation(message.q) == pytest.approx(T[:3, :3], abs=1e-5)
        assert message.time_usec * 1e-6 == pytest.approx(ardupilot.shows.at(taken_s), abs=2e-3)
        ardupilot.pass_time(0.3)
    assert ardupilot.output.stats().sent_unsynchronised == 0


@pytest.mark.parametrize("attitude", ["ATTITUDE_QUATERNION", "ATTITUDE"])
def test_px4_reads_the_pad_in_its_local_frame(attitude: str) -> None:
    flight = _flight(common.MAV_AUTOPILOT_PX4)
    expected = TRUTH.T_local_target
    for _ in range(10):
        flight.stream(flight.now.now_s, attitude=attitude)
        flight.step()
        taken_s, message = _sent(flight)
        _check_picture(message, taken_s)
        assert (message.frame, message.target_num) == (common.MAV_FRAME_LOCAL_NED, 0)
        # Two milliseconds of the vehicle's motion, and millimetres of interpolation.
        assert [message.x, message.y, message.z] == pytest.approx(expected[:3, 3], abs=0.01)
        assert rotation(message.q) == pytest.approx(expected[:3, :3], abs=2e-3)
        assert message.time_usec * 1e-6 == pytest.approx(flight.shows.at(taken_s), abs=2e-3)
        flight.pass_time(0.3)
    flight.close()


def test_px4_waits_for_where_the_vehicle_was(px4: Flight) -> None:
    px4.stream(px4.now.now_s - 0.1)
    px4.step()
    taken_s = px4.now.now_s
    px4.end.messages.clear()
    px4.output.take(report(TRUTH.pose(taken_s), taken_s))
    assert not px4.end.of("LANDING_TARGET")
    px4.now.advance(0.03)
    px4.stream(taken_s)
    px4.step()
    (message,) = px4.end.of("LANDING_TARGET")
    assert message.time_usec * 1e-6 == pytest.approx(px4.shows.at(taken_s), abs=2e-3)


def test_px4_is_told_nothing_where_the_vehicle_was_is_not_known(px4: Flight) -> None:
    px4.pass_time(2.0)
    before = px4.output.stats()
    px4.end.messages.clear()
    px4.output.take(report(TRUTH.pose(px4.now.now_s), px4.now.now_s))
    px4.step()
    assert not px4.end.of("LANDING_TARGET")
    after = px4.output.stats()
    assert after.sent == before.sent
    missed = after.withheld["no_vehicle_pose"] - before.withheld.get("no_vehicle_pose", 0)
    assert missed == 1
    assert any("were not sent" in text for text in px4.told)


def test_range_and_bearing_alone_are_sent_without_an_attitude(
    ardupilot: Flight, px4: Flight
) -> None:
    for flight in (ardupilot, px4):
        flight.stream(flight.now.now_s)
        flight.step()
        taken_s, message = _sent(flight, sigma_deg=20.0)
        _check_picture(message, taken_s)
        expected = TRUTH.T_local_target if flight is px4 else TRUTH.pad_in_body(taken_s)
        assert [message.x, message.y, message.z] == pytest.approx(expected[:3, 3], abs=0.01)
        assert message.q == [0, 0, 0, 0]


def test_a_position_estimate_holds_the_vehicle_over_the_pad() -> None:
    flight = Flight(truth=TRUTH, mount=MOUNT, message="position_estimate", heading_deg=45.0)
    flight.meet()
    flight.pass_time(8.0)
    taken_s = flight.now.now_s
    flight.output.take(report(TRUTH.pose(taken_s), taken_s))
    (message,) = flight.end.of("VISION_POSITION_ESTIMATE")
    T = TRUTH.T_local_body(taken_s)
    over = T[:3, 3] - TRUTH.T_local_pad[:3, 3]
    assert [message.x, message.y, message.z] == pytest.approx(over, abs=1e-5)
    assert message.yaw == pytest.approx(math.atan2(T[1, 0], T[0, 0]), abs=1e-6)
    assert message.usec * 1e-6 == pytest.approx(flight.shows.at(taken_s), abs=2e-3)
    # A millimetre of the camera, and what its attitude makes of its lever.
    assert message.covariance[0] == pytest.approx(1e-6, rel=0.1)
    # Without an attitude that can be used nothing is said.
    flight.output.take(report(TRUTH.pose(taken_s), taken_s, sigma_deg=20.0))
    assert len(flight.end.of("VISION_POSITION_ESTIMATE")) == 1
    assert not flight.end.of("LANDING_TARGET")
    assert flight.output.stats().withheld == {"no_attitude": 1}
    flight.close()


def test_px4_takes_our_times_for_its_own(px4: Flight) -> None:
    # As PX4's receiver does it: half of its time there and back, less what was answered.
    offsets_s = []
    for _ in range(20):
        asked_ns = round(px4.shows.at(px4.now.now_s) * 1e9)
        px4.end.messages.clear()
        px4.now.advance(0.002)
        px4.end.send(common.MAVLink_timesync_message(0, asked_ns))
        px4.step()
        (answer,) = [m for m in px4.end.of("TIMESYNC") if m.tc1]
        assert answer.ts1 == asked_ns
        px4.now.advance(0.002)
        now_ns = round(px4.shows.at(px4.now.now_s) * 1e9)
        offsets_s.append((asked_ns + now_ns - 2 * answer.tc1) / 2e9)
    assert np.abs(offsets_s).max() < 2e-3
