import copy
import json
import os
from pathlib import Path

import flight_orders
import frame_records
import numpy as np
import pytest
import videos
from places import ROOT

from padstudio.flights import batch
from padstudio.flights.tasks.detectors import Recipe
from padstudio.workers import pool

SAMPLES = ROOT / "samples"
FOOTAGE = ROOT / "tests" / "footage"
LANDING = FOOTAGE / "flights" / "landing.mp4"


def recipe(folder, pad, camera):
    return Recipe((folder / pad).read_text(), (folder / camera).read_text())


SAMPLE = recipe(SAMPLES, "pad.json", "camera.yaml")
LANDED = recipe(FOOTAGE, "pad_a.json", "camera_drone_2k7.yaml")


def detect(names, **options):
    return list(batch.detect(batch.plan([SAMPLES / name for name in names], SAMPLE), **options))


def test_records_agree_with_the_truth():
    truth = json.loads((SAMPLES / "truth.json").read_text(encoding="utf-8"))
    for item, record in zip(truth, detect([t["file"] for t in truth]), strict=True):
        assert record["source"].endswith(item["file"])
        if "position_mm" in item:
            limit_mm = 0.01 * item["position_mm"][2]
            assert record["position_mm"] == pytest.approx(item["position_mm"], abs=limit_mm)
        else:
            assert record["status"] == "failed"


def test_no_frames_give_no_records():
    assert detect([]) == []
    assert detect([], jobs=2) == []


def die(*_arguments):
    os.kill(os.getpid(), 9)


def test_a_worker_that_dies_costs_one_record(monkeypatch):
    # The function goes to the worker by name, so the name of one that ends its process is sent.
    real = batch._run_alone
    calls = iter([real, die, real])

    class Pool(pool.WorkerPool):
        def submit(self, function, *arguments, timeout_s):
            assert function is real
            return super().submit(next(calls), *arguments, timeout_s=timeout_s)

    monkeypatch.setattr(pool, "WorkerPool", Pool)
    records = detect(["height_150mm.jpg"] * 3, jobs=2)
    assert [record["status"] for record in records] == ["ok", "failed", "ok"]
    assert (records[1]["stage"], records[1]["reason"]) == ("read", "worker_crashed")


def test_more_frames_than_may_wait():
    records = detect(["truth.json"] * 12, jobs=2)
    assert [record["reason"] for record in records] == ["not_an_image"] * 12


def test_a_consumer_that_stops_early_ends_the_workers():
    records = batch.detect(batch.plan([SAMPLES / "truth.json"] * 40, SAMPLE), jobs=2)
    next(records)
    records.close()
    with pytest.raises(StopIteration):
        next(records)


def test_a_video_is_read_in_pieces_with_its_own_times():
    pieces = batch.plan([LANDING], LANDED, stride=20)
    assert [number for piece in pieces for number in piece.numbers] == [0, 20, 40]
    records = list(batch.detect(pieces))
    truth = json.loads(LANDING.with_suffix(".truth.json").read_text(encoding="utf-8"))
    for record in records:
        assert record["source"] == LANDING.as_posix()
        assert record["time_s"] == pytest.approx(record["frame"] / 30, abs=1e-6)
        true = truth["frames"][record["frame"]]["position_mm"]
        assert record["position_mm"] == pytest.approx(true, abs=0.02 * true[2])
        assert len(record["covariance"]) == 21
        assert record["frame_px"] == [2720, 1530]
    assert [record["frame"] for record in records] == [0, 20, 40]


def test_frames_and_times_go_on_from_file_to_file(tmp_path):
    first = videos.write(tmp_path / "a.mp4", 10)
    broken = tmp_path / "b.mp4"
    broken.write_text("no video")
    second = videos.write(tmp_path / "c.mp4", 7)
    small = Recipe(flight_orders.PAD, flight_orders.camera())
    still = SAMPLES / "truth.json"
    pieces = batch.plan([first, broken, second, still], small, stride=3)
    found = [
        (Path(piece.source).name, number, about["time_s"])
        for piece in pieces
        for number, about in zip(piece.numbers, piece.about, strict=True)
    ]
    # Every third frame of all, as a flight of them has it; 25 a second.
    times = [0, 3 / 25, 6 / 25, 9 / 25, 10 / 25, (12 - 1) / 25, (15 - 1) / 25, None]
    assert [(name, number) for name, number, _ in found] == [
        *(("a.mp4", number) for number in (0, 3, 6, 9)),
        ("b.mp4", 10),
        *(("c.mp4", number) for number in (12, 15)),
        ("truth.json", 18),
    ]
    assert [time_s for *_, time_s in found][:-1] == pytest.approx(times[:-1])
    assert found[-1][2] is None
    (record,) = batch.detect([piece for piece in pieces if piece.source == broken.as_posix()])
    assert (record["frame"], record["reason"]) == (10, "not_a_video")
    assert record["time_s"] == pytest.approx(10 / 25)


def test_poses_of_a_video_are_fused_as_asked_for():
    pieces = batch.plan([LANDING], LANDED, stride=6)
    alone, filtered, smoothed = (
        list(batch.detect(pieces, fusion=fusion)) for fusion in ("none", "filter", "smooth")
    )
    truth = json.loads(LANDING.with_suffix(".truth.json").read_text(encoding="utf-8"))["frames"]
    for own, *fused in zip(alone, filtered, smoothed, strict=True):
        assert own["estimate"] == "frame"
        assert [record["estimate"] for record in fused] == ["filtered", "smoothed"]
        true = truth[own["frame"]]["position_mm"]
        for record in fused:
            assert record["frame"] == own["frame"]
            assert record["single"]["position_mm"] == pytest.approx(own["position_mm"], abs=1e-6)
            assert record["position_mm"] == pytest.approx(true, abs=0.02 * true[2])
            assert record["single"]["covariance"] == own["covariance"]


def test_a_run_that_goes_on_fuses_as_one_that_was_not_broken_off(monkeypatch):
    numbers = [range(start, start + 40) for start in range(0, 160, 40)]
    records = frame_records.records(160)

    def run(piece):
        return copy.deepcopy(records[piece.numbers.start : piece.numbers.stop])

    monkeypatch.setattr(batch, "_here", run)
    pieces = [batch.Piece("a.mp4", some, None) for some in numbers]
    for fusion in ("filter", "smooth"):
        whole = list(batch.detect(pieces, fusion=fusion))
        done = {("a.mp4", number) for number in range(90)}
        rest = list(batch.detect(pieces, done=done, fusion=fusion))
        assert [record["frame"] for record in rest] == list(range(90, 160))
        for a, b in zip(whole[90:], rest, strict=True):
            if a["status"] == "ok":
                off = np.abs(np.subtract(a["position_mm"], b["position_mm"]))
                assert (off < 0.05 * np.array(a["position_sigma_mm"])).all()


def test_done_frames_are_left_out():
    pieces = batch.plan([LANDING, SAMPLES / "truth.json"], LANDED, stride=20)
    done = {(LANDING.as_posix(), 0), (LANDING.as_posix(), 20), (LANDING.as_posix(), 40)}
    records = list(batch.detect(pieces, done=done))
    assert [record["source"] for record in records] == [(SAMPLES / "truth.json").as_posix()]


def test_a_video_that_is_none_costs_one_record(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_text("no video")
    (record,) = batch.detect(batch.plan([path], SAMPLE))
    assert (record["stage"], record["reason"]) == ("read", "not_a_video")
    assert not record["detail"].startswith(path.as_posix())


def test_a_worker_that_dies_costs_the_frames_of_its_piece(monkeypatch):
    class Pool(pool.WorkerPool):
        def submit(self, function, *arguments, timeout_s):
            return super().submit(die, *arguments, timeout_s=timeout_s)

    monkeypatch.setattr(pool, "WorkerPool", Pool)
    records = list(batch.detect(batch.plan([LANDING], LANDED, stride=20), jobs=2))
    assert [record["frame"] for record in records] == [0, 20, 40]
    assert {record["reason"] for record in records} == {"worker_crashed"}
    assert records[2]["time_s"] == pytest.approx(40 / 30, abs=1e-6)
