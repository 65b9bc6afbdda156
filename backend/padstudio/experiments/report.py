"""What an experiment says: sections of words, claims, tables and figures.

A report knows no form; `padstudio.experiments.writers` makes Markdown, HTML, CSV and plain values
of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

#: Called with the steps that are over and those there are in all; it may raise to end the work.
Progress = Callable[[int, int], None]
#: An experiment: takes an order, an empty folder of its own for what it does not keep in mind, and
#: a progress; the same order gives the same report.
Experiment = Callable[[Mapping[str, Any], Path, Progress], "Report"]

Cell = str | int | float | None
Verdict = Literal["held", "held within", "does not hold", "not measured"]

#: Where there is no figure.
NONE = "–"
_MINUS = "−"


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    title : str
        With the unit.
    decimals : int or None
        Of its figures as people read them; None leaves texts and whole numbers as they are.
    """

    title: str
    decimals: int | None = None

    def shown(self, cell: Cell) -> str:
        """A cell as people read it."""
        if cell is None or (isinstance(cell, float) and not math.isfinite(cell)):
            return NONE
        if isinstance(cell, str):
            return cell
        text = f"{cell:.{self.decimals or 0}f}"
        if text.strip("-0.") == "":
            text = text.lstrip("-")
        return text.replace("-", _MINUS)


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    name : str
        Stem of its file: lower-case letters, digits and hyphens.
    caption : str
        What stands in it, and under which conditions.
    columns : tuple of Column
    rows : tuple of tuple of Cell
    """

    name: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @property
    def shown(self) -> list[list[str]]:
        """The rows as people read them."""
        return [
            [column.shown(cell) for column, cell in zip(self.columns, row, strict=True)]
            for row in self.rows
        ]


@dataclass(frozen=True)
class Figure:
    """A picture.

    Attributes
    ----------
    name : str
        Stem of its file, as of a table.
    suffix : {".svg", ".webp"}
    data : bytes
        The file.
    caption : str
    words : str
        What is to be seen, for who does not see it.
    """

    name: str
    suffix: Literal[".svg", ".webp"]
    data: bytes
    caption: str
    words: str = ""

    @property
    def file(self) -> str:
        """The file's name."""
        return self.name + self.suffix


@dataclass(frozen=True)
class Claim:
    """What was claimed, and what was found.

    Attributes
    ----------
    text : str
        The claim.
    verdict : Verdict
    because : str
        The figures that it rests on, whole sentences.
    within : str
        Of a claim that is held within something: what that is.
    """

    text: str
    verdict: Verdict
    because: str
    within: str = ""

    @property
    def sentence(self) -> str:
        """The verdict as a sentence."""
        said = f"{self.verdict} {self.within}".strip()
        return said[0].upper() + said[1:] + "."


@dataclass(frozen=True)
class Section:
    """A part of a report; what it does not have is left empty."""

    title: str
    words: tuple[str, ...] = ()
    claims: tuple[Claim, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure, ...] = ()


@dataclass(frozen=True)
class Report:
    """All that an experiment says.

    Attributes
    ----------
    title : str
    words : tuple of str
        Paragraphs before the first section.
    sections : tuple of Section
    """

    title: str
    words: tuple[str, ...]
    sections: tuple[Section, ...]

    @property
    def tables(self) -> list[Table]:
        """The tables of all sections."""
        return [table for section in self.sections for table in section.tables]

    @property
    def figures(self) -> list[Figure]:
        """The figures of all sections."""
        return [figure for section in self.sections for figure in section.figures]
