"""Holds docs/detection.md to the code."""

import re

import cv2
import pytest
from paper_frames import FOOTAGE

from padstudio.vision.cells.evidence import LEAST_KAPPA
from padstudio.vision.stage.parameter import Parameter, parameters_of
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import STAGES, Reason

TEXT = (FOOTAGE.parents[1] / "docs" / "detection.md").read_text(encoding="utf-8")


def test_the_table_of_reasons_is_the_list_of_reasons():
    table = TEXT[TEXT.index("## When there is no pose") :]
    assert re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE) == [str(reason) for reason in Reason]


def test_the_rule_is_the_codes():
    bound = DetectorParams().log10_false_alarm
    digits = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
    assert f"≥ k) ≤ 10⁻{str(round(-bound)).translate(digits)}**" in TEXT
    assert f"≥ {LEAST_KAPPA}**" in TEXT


def row(parameter: Parameter) -> str:
    """A parameter's line of the table."""
    low, high = parameter.low, parameter.high
    default, bounds = f"{parameter.default:g}", f"{low:.8g} … {high:.8g}"
    if parameter.kind == "bool":
        default, bounds = "on" if parameter.default else "off", "on, off"
    elif parameter.not_below is not None:
        bounds = f"`{parameter.not_below}` … {high:.8g}"
    elif parameter.not_above is not None:
        bounds = f"{low:.8g} … `{parameter.not_above}`"
    cells = (f"`{parameter.name}`", default, bounds, parameter.unit or "–", parameter.text)
    return f"| {' | '.join(cells)} |"


def test_the_table_of_parameters_is_the_list_of_parameters():
    section = TEXT[TEXT.index("## Parameters") : TEXT.index("## When there is no pose")]
    rows = [line for line in section.splitlines() if line.startswith("| `")]
    assert rows == [row(parameter) for parameter in parameters_of(DetectorParams())]


def test_stages_named_are_stages():
    dense = TEXT[TEXT.index("### How `dense` works") : TEXT.index("### When `dense` gives")]
    named = set(re.findall(r"`(\w+)`", dense)) - {"dense"}
    assert named <= set(STAGES)
    assert set(STAGES) - named <= {"block_mean"}


def test_the_examples_run(monkeypatch, capsys):
    monkeypatch.chdir(FOOTAGE)
    names = {"frame": cv2.imread("stills/d17.jpg")}
    for example in re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL):
        exec(compile(example, "docs/detection.md", "exec"), names)
    assert names["detection"].ok
    assert all(pose is not None for pose in names["poses"])
    assert names["picture"].ndim == names["edges"].ndim == 3
    assert "[" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["bench_covariance.py", "bench_false_alarms.py"])
def test_benchmarks_named_are_there(name):
    assert (FOOTAGE.parent / "benchmarks" / name).exists()
    assert name in TEXT
