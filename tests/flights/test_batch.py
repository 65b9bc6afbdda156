import json
import os
from pathlib import Path

import pytest

from padstudio import Camera, Pad
from padstudio.flights import batch

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "samples"


def detect(names, **options):
    pad, camera = Pad.load(SAMPLES / "pad.json"), Camera.load(SAMPLES / "camera.yaml")
    return list(batch.detect_stills([SAMPLES / name for name in names], pad, camera, **options))


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
    real = batch._detect_alone
    calls = iter([real, die, real])

    class Pool(batch.WorkerPool):
        def submit(self, function, *arguments, timeout_s):
            assert function is real
            return super().submit(next(calls), *arguments, timeout_s=timeout_s)

    monkeypatch.setattr(batch, "WorkerPool", Pool)
    records = detect(["height_150mm.jpg"] * 3, jobs=2)
    assert [record["status"] for record in records] == ["ok", "failed", "ok"]
    assert (records[1]["stage"], records[1]["reason"]) == ("read", "worker_crashed")


def test_more_frames_than_may_wait():
    records = detect(["truth.json"] * 12, jobs=2)
    assert [record["reason"] for record in records] == ["not_an_image"] * 12


def test_a_consumer_that_stops_early_ends_the_workers():
    pad, camera = Pad.load(SAMPLES / "pad.json"), Camera.load(SAMPLES / "camera.yaml")
    records = batch.detect_stills([SAMPLES / "truth.json"] * 40, pad, camera, jobs=2)
    next(records)
    records.close()
    with pytest.raises(StopIteration):
        next(records)
