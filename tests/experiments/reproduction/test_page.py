"""docs/reproduction.md is what the command writes: a small part of it is made again."""

from __future__ import annotations

import re

import pytest
from places import DOCS

from padstudio.experiments.reproduction.plan import EXPERIMENTS, PLACES, SEEDS, Shot, shots_of
from padstudio.experiments.reproduction.reading import read_shot
from padstudio.experiments.reproduction.sections import TITLE
from padstudio.experiments.reproduction.tables import samples_table
from padstudio.experiments.writers import MARKDOWN

PAGE = DOCS / "reproduction.md"
TEXT = PAGE.read_text(encoding="utf-8")
# A tenth in the table, and what another processor rounds otherwise.
_WITHIN_MM = 0.15


def test_the_last_sample_of_the_landing_comes_out_as_on_the_page() -> None:
    table = samples_table([read_shot(Shot("landing", len(PLACES["landing"]) - 1, 0))])
    heads = "| " + " | ".join(column.title for column in table.columns) + " |"
    rows = TEXT[TEXT.index(heads) :].split("\n\n")[0].splitlines()[2:]
    on_page, again = rows[-1].strip("| ").split(" | ")[1:], table.shown[0][1:]
    for there, here in zip(on_page, again, strict=True):
        if re.fullmatch(r"−?\d+\.\d", there):
            assert _number(here) == pytest.approx(_number(there), abs=_WITHIN_MM)
        else:
            assert here == there


def _number(text: str) -> float:
    return float(text.replace("−", "-"))


def test_the_page_is_of_all_experiments_and_its_pictures_are_there() -> None:
    assert TEXT.startswith(f"# {TITLE}\n")
    seeds = int(re.search(r"(\d+) of each place", TEXT)[1])  # type: ignore[index]
    assert f"{len(shots_of(EXPERIMENTS, seeds))} frames: " in TEXT
    assert seeds <= SEEDS
    pictures = re.findall(r"!\[[^\]]+\]\((images/reproduction-[^)]+)\)", TEXT)
    assert len(pictures) == len(set(pictures)) >= 12
    for picture in pictures:
        assert 0 < (DOCS / picture).stat().st_size < 60_000
    there = {f"images/{path.name}" for path in (DOCS / "images").glob("reproduction-*")}
    assert there == set(pictures)


def test_the_page_names_no_file_that_it_does_not_have() -> None:
    assert MARKDOWN not in TEXT
