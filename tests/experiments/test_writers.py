"""A report in its forms."""

from __future__ import annotations

import csv
from html.parser import HTMLParser
from pathlib import Path

import small_experiment

from padstudio.experiments.report import Column
from padstudio.experiments.writers import (
    HTML_POLICY,
    html,
    markdown,
    plain,
    write_page,
    write_report,
)

REPORT = small_experiment.report()


def test_cells_are_shown_as_people_read_them() -> None:
    column = Column("y", 2)
    cells = (1.23456, -1.5, -0.001, None, float("nan"), "a", 3)
    assert [column.shown(cell) for cell in cells] == [
        "1.23", "−1.50", "0.00", "–", "–", "a", "3.00",
    ]  # fmt: skip
    assert Column("n").shown(12) == "12"


def test_markdown_has_all_of_it() -> None:
    lines = markdown(REPORT, "images/x-").splitlines()
    assert lines[0] == "# Small"
    assert "- It is small. **Held within reason.** It has 3 rows." in lines
    assert "![a triangle](images/x-sketch.svg)" in lines
    assert "| b | 0.00 |" in lines
    assert "|---|---:|" in lines


def test_figures_of_a_table_are_whole_in_its_csv(tmp_path: Path) -> None:
    files = write_report(REPORT, tmp_path / "out")
    assert {path.name for path in files} == {"report.md", "report.html", "small.csv", "sketch.svg"}
    text = (tmp_path / "out" / "small.csv").read_text(encoding="utf-8")
    rows = list(csv.reader(text.splitlines()))
    assert rows == [["x", "y, mm"], ["a", "1.23456"], ["b", "-0.001"], ["c", ""]]


class _Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))


def test_the_html_file_needs_nothing_and_runs_nothing() -> None:
    text = html(REPORT)
    tags = _Tags()
    tags.feed(text)
    names = [name for name, _ in tags.found]
    assert "script" not in names
    # What looks like HTML in a caption stays text.
    assert "b" not in names
    (image,) = [values for name, values in tags.found if name == "img"]
    assert str(image["src"]).startswith("data:image/svg+xml;base64,")
    for _, values in tags.found:
        assert not [name for name in values if name.startswith("on") or name == "style"]
    assert "script-src" not in HTML_POLICY
    assert "default-src 'none'" in HTML_POLICY


def test_a_page_has_its_pictures_beside_it(tmp_path: Path) -> None:
    files = write_page(REPORT, tmp_path / "page.md")
    picture = tmp_path / "images" / "page-sketch.svg"
    assert files == [tmp_path / "page.md", picture]
    assert picture.read_bytes() == small_experiment.SVG
    assert "(images/page-sketch.svg)" in files[0].read_text(encoding="utf-8")


def test_plain_values_name_files() -> None:
    (section,) = plain(REPORT)["sections"]
    assert section["tables"][0]["file"] == "small.csv"
    assert section["figures"] == [
        {"file": "sketch.svg", "caption": "A triangle.", "words": "a triangle"}
    ]
