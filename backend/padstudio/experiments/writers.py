"""Writes a report: Markdown, one HTML file that needs nothing beside it, CSV, plain values."""

from __future__ import annotations

import base64
import csv
import hashlib
import io
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from padstudio.experiments.report import Figure, Report, Section, Table

#: The files that every report has.
MARKDOWN, HTML = "report.md", "report.html"
MEDIA_TYPES = {
    ".md": "text/markdown",
    ".html": "text/html",
    ".csv": "text/csv",
    ".svg": "image/svg+xml",
    ".webp": "image/webp",
}
_STYLE = """
:root { color-scheme: light dark; }
body { margin: 2rem auto; max-width: 62rem; padding: 0 1rem; font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; } h2 { margin-top: 2.5rem; font-size: 1.2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding: .5rem 0; }
th, td { padding: .15rem .6rem; border-bottom: 1px solid #8885; text-align: right; }
:is(th, td):first-child { text-align: left; }
.scroll { overflow-x: auto; margin: 1.5rem 0; }
figure { margin: 1.5rem 0; } img { max-width: 100%; height: auto; background: #fff; }
figcaption { font-size: .9rem; }
.claim { margin: .8rem 0; padding-left: .8rem; border-left: 4px solid #888; }
.held { border-color: #1a6b35; } .does-not-hold { border-color: #a8201f; }
.held-within { border-color: #b97a00; }
"""
_DIGEST = base64.b64encode(hashlib.sha256(_STYLE.encode()).digest()).decode()
#: What a browser may do with the HTML file: paint its own pictures in its own style, no more.
HTML_POLICY = (
    f"default-src 'none'; img-src data:; style-src 'sha256-{_DIGEST}'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'; sandbox"
)


def write_report(report: Report, folder: Path) -> list[Path]:
    """Write a report into a folder, over what stands there under the same names.

    Parameters
    ----------
    report : Report
    folder : Path
        Made where it is missing.

    Returns
    -------
    list of Path
        The files, `MARKDOWN` first.
    """
    folder.mkdir(exist_ok=True)
    contents = {MARKDOWN: markdown(report).encode(), HTML: html(report).encode()}
    contents |= {f"{table.name}.csv": csv_text(table).encode() for table in report.tables}
    contents |= {figure.file: figure.data for figure in report.figures}
    for name, data in contents.items():
        (folder / name).write_bytes(data)
    return [folder / name for name in contents]


def write_page(report: Report, file: Path) -> list[Path]:
    """Write a report as one page of a documentation, its pictures in ``images`` beside it.

    Parameters
    ----------
    report : Report
    file : Path
        Of Markdown; pictures have its stem before their names.

    Returns
    -------
    list of Path
        The files, the page first.
    """
    folder, prefix = file.parent / "images", f"{file.stem}-"
    folder.mkdir(exist_ok=True)
    file.write_text(markdown(report, f"images/{prefix}"), encoding="utf-8")
    pictures = {folder / (prefix + figure.file): figure.data for figure in report.figures}
    for path, data in pictures.items():
        path.write_bytes(data)
    return [file, *pictures]


def markdown(report: Report, pictures: str = "") -> str:
    """A report as Markdown.

    Parameters
    ----------
    report : Report
    pictures : str
        What stands before the names of pictures: ``images/reproduction-``, say.
    """
    lines = [f"# {report.title}", ""]
    for words in report.words:
        lines += [words, ""]
    for section in report.sections:
        lines += _markdown_section(section, pictures)
    return "\n".join(lines).rstrip() + "\n"


def _markdown_section(section: Section, pictures: str) -> Iterator[str]:
    yield from (f"## {section.title}", "")
    for words in section.words:
        yield from (words, "")
    for claim in section.claims:
        yield f"- {claim.text} **{claim.sentence}** {claim.because}"
    if section.claims:
        yield ""
    for figure in section.figures:
        yield from (f"![{figure.words or figure.caption}]({pictures}{figure.file})", "")
        yield from (f"*{figure.caption}*", "")
    for table in section.tables:
        yield from (table.caption, "")
        yield _row([column.title for column in table.columns])
        yield "|" + "|".join("---" if k == 0 else "---:" for k in range(len(table.columns))) + "|"
        yield from map(_row, table.shown)
        yield ""


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def html(report: Report) -> str:
    """A report as one HTML file without scripts, its pictures within."""
    parts = [f"<h1>{escape(report.title)}</h1>"]
    parts += [f"<p>{escape(words)}</p>" for words in report.words]
    for section in report.sections:
        parts += _html_section(section)
    title = escape(report.title)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title><style>{_STYLE}</style></head><body>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )


def _html_section(section: Section) -> Iterator[str]:
    yield f"<h2>{escape(section.title)}</h2>"
    yield from (f"<p>{escape(words)}</p>" for words in section.words)
    for claim in section.claims:
        kind = claim.verdict.replace(" ", "-")
        yield (
            f'<p class="claim {kind}">{escape(claim.text)} <strong>{escape(claim.sentence)}'
            f"</strong> {escape(claim.because)}</p>"
        )
    for figure in section.figures:
        yield (
            f'<figure><img src="{_data_url(figure)}" alt="{escape(figure.words)}">'
            f"<figcaption>{escape(figure.caption)}</figcaption></figure>"
        )
    for table in section.tables:
        heads = "".join(f'<th scope="col">{escape(column.title)}</th>' for column in table.columns)
        rows = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>\n"
            for row in table.shown
        )
        yield (
            f'<div class="scroll"><table><caption>{escape(table.caption)}</caption>'
            f"<thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table></div>"
        )


def _data_url(figure: Figure) -> str:
    data = base64.b64encode(figure.data).decode()
    return f"data:{MEDIA_TYPES[figure.suffix]};base64,{data}"


def csv_text(table: Table) -> str:
    """A table as CSV (RFC 4180), figures unrounded; cells without a figure are empty."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow([column.title for column in table.columns])
    writer.writerows(table.rows)
    return text.getvalue()


def plain(report: Report) -> dict[str, Any]:
    """A report as plain values, as the page shows it: cells are texts, pictures names of files."""
    return {
        "title": report.title,
        "words": list(report.words),
        "sections": [_plain_section(section) for section in report.sections],
    }


def _plain_section(section: Section) -> dict[str, Any]:
    return {
        "title": section.title,
        "words": list(section.words),
        "claims": [
            {
                "text": claim.text,
                "verdict": claim.verdict,
                "sentence": claim.sentence,
                "because": claim.because,
            }
            for claim in section.claims
        ],
        "tables": [
            {
                "caption": table.caption,
                "columns": [column.title for column in table.columns],
                "rows": table.shown,
                "file": f"{table.name}.csv",
            }
            for table in section.tables
        ],
        "figures": [
            {"file": figure.file, "caption": figure.caption, "words": figure.words}
            for figure in section.figures
        ],
    }
