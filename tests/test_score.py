import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parent / "benchmarks" / "score.py"
LEVEL = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
# A turn of 5 degrees about the optical axis.
TURNED = [[0.9961947, -0.0871557, 0], [-0.0871557, -0.9961947, 0], [0, 0, -1]]


def truth(file, **values):
    return {
        "file": f"stills/{file}.jpg",
        "group": "descent",
        "position_mm": [0, 0, 1000],
        "rotation": LEVEL,
    } | values


def pose(source, position_mm=(0, 0, 1000), rotation=LEVEL):
    return {
        "source": f"elsewhere/{source}.png",
        "frame": 0,
        "status": "ok",
        "position_mm": position_mm,
        "rotation": rotation,
    }


def failed(source):
    return {
        "source": source,
        "frame": 0,
        "status": "failed",
        "stage": "lines",
        "reason": "no_lattice",
    }


def run(folder, truths, poses, name="truth.json"):
    (folder / name).write_text(json.dumps(truths))
    (folder / "poses.jsonl").write_text("\n".join(map(json.dumps, poses)) + "\n\n")
    arguments = [folder / name, folder / "poses.jsonl", "-v", "--json", folder / "out.json"]
    done = subprocess.run(
        [sys.executable, SCRIPT, *arguments], capture_output=True, text=True, check=False
    )
    return done, json.loads((folder / "out.json").read_text())


@pytest.mark.parametrize(
    ("answer", "verdict"),
    [
        (pose("a", (20.9, 0, 1000)), "good"),
        (pose("a", (21.1, 0, 1000)), "poor"),
        (pose("a", (0, 104.9, 1000)), "poor"),
        (pose("a", (0, 105.1, 1000)), "false"),
        (pose("a", rotation=TURNED), "poor"),
        (pose("a", rotation=[[0, 1, 0], [1, 0, 0], [0, 0, -1]]), "false"),
        (failed("a"), "miss"),
        (pose("b"), "miss"),
    ],
)
def test_verdicts(tmp_path, answer, verdict):
    done, figures = run(tmp_path, [truth("a")], [answer])
    assert figures["total"] == {verdict: 1}
    assert done.returncode == (verdict == "false")
    assert ("a:0" in done.stdout) == (verdict != "good")


def test_the_nearest_of_poses_that_are_as_true_counts(tmp_path):
    moved = {"position_mm": [300, 0, 1000], "rotation": TURNED}
    answer = pose("a", (301, 0, 1000), TURNED)
    _, figures = run(tmp_path, [truth("a", also_true=[moved])], [answer])
    assert figures["total"] == {"good": 1}
    assert run(tmp_path, [truth("a")], [answer])[1]["total"] == {"false": 1}


def test_any_pose_where_there_is_no_pad_is_false(tmp_path):
    negatives = [{"file": "negatives/a.jpg"}, {"file": "negatives/b.jpg"}]
    _, figures = run(tmp_path, negatives, [pose("a"), failed("b")])
    assert figures["groups"] == {"no pad": {"false": 1, "good": 1}}
    assert figures["median_position_percent"] is None


def test_frames_of_a_flight_are_told_apart(tmp_path):
    flight = {"fps": 30, "frames": [truth("", frame=i, time_s=i / 30) for i in range(3)]}
    for frame in flight["frames"]:
        del frame["file"], frame["group"]
    poses = [pose("landing") | {"frame": 1}, pose("landing", (5, 0, 1000)) | {"frame": 2}]
    _, figures = run(tmp_path, flight, poses, "landing.truth.json")
    assert figures["groups"] == {"flight": {"miss": 1, "good": 2}}
    assert figures["median_position_percent"] == pytest.approx(0.25)
