"""Text that prints: every name comes out as words of one embedded font.

FiraGO (SIL Open Font License) covers Latin, Greek, Cyrillic, Georgian, Hebrew, Arabic, Thai and
Devanagari. Arabic letters are joined and right-to-left runs put in order here, since a PDF shows
glyphs as they are placed; Devanagari comes out unjoined. What the font lacks is spelled out:
``[helicopter]`` for an emoji, ``[U+4E2D]`` for other characters.
"""

from __future__ import annotations

import io
import unicodedata
from functools import cache

import arabic_reshaper
import pymupdf_fonts
from bidi import get_display
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont

FONT = "FiraGO"
_LONGEST_NAME = 30
_ELLIPSIS = "…"


@cache
def load_font() -> TTFont:
    """The font, registered with ReportLab."""
    font = TTFont(FONT, io.BytesIO(pymupdf_fonts.fontbuffers["figo"]()), shapable=False)
    pdfmetrics.registerFont(font)
    return font


def printable(text: str) -> str:
    """The text in reading order, every character one that the font has."""
    glyphs = load_font().face.charToGlyph
    spelled = "".join(
        char if ord(char) in glyphs and unicodedata.category(char) != "Cf" else _spell(char)
        for char in unicodedata.normalize("NFC", text)
    )
    return _visual(" ".join(spelled.split()))


def fit(text: str, size: float, width: float) -> tuple[str, float]:
    """Printable text and its size, made smaller to 60 % and then shorter, to stay within a width.

    `size` and `width` share a unit.
    """
    shown = printable(text)
    if (full := _width(shown, size)) <= width:
        return shown, size
    size *= max(width / full, 0.6)
    while _width(shown, size) > width and text:
        text = text[:-1]
        shown = printable(text + _ELLIPSIS)
    return shown, size


def _width(text: str, size: float) -> float:
    load_font()
    return float(pdfmetrics.stringWidth(text, FONT, size))


def _visual(text: str) -> str:
    """Joined Arabic letters, and runs in the order they are placed from left to right."""
    if not any(unicodedata.bidirectional(char) in ("R", "AL", "AN") for char in text):
        return text
    return str(get_display(arabic_reshaper.reshape(text)))


def _spell(char: str) -> str:
    """Words for a character that the font lacks; nothing for one without a shape."""
    category = unicodedata.category(char)
    if category in ("Cc", "Zs", "Zl", "Zp"):
        return " "
    if category in ("Cf", "Mn", "Sk", "Cs"):
        return ""
    name = unicodedata.name(char, "").lower()
    if category == "So" and 0 < len(name) <= _LONGEST_NAME:
        return f"[{name}]"
    return f"[U+{ord(char):04X}]"
