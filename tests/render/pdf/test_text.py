from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reportlab.pdfbase import pdfmetrics

from padstudio.render.pdf.text import FONT, fit, load_font, printable


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Größe Ñandú Ελλάδα Київ", "Größe Ñandú Ελλάδα Київ"),
        ("Hof 🚁", "Hof [helicopter]"),
        ("a\n\tb\x00c", "a b c"),
        ("👨\u200d👩", "[man][woman]"),
        ("中", "[U+4E2D]"),
        # The first letter read is placed last from the left.
        ("שלום", "םולש"),
        ("שלום 12", "12 םולש"),
        ("", ""),
    ],
)
def test_names_become_glyphs_of_the_font(text: str, shown: str) -> None:
    assert printable(text) == shown


def test_arabic_letters_are_joined() -> None:
    shown = printable("سلام")
    # Presentation forms, right to left: meem apart, lam with alef, seen at the beginning.
    assert shown == "\ufee1\ufefc\ufeb3"


@given(st.text(max_size=40))
def test_any_text_is_printable(text: str) -> None:
    glyphs = load_font().face.charToGlyph
    assert all(ord(char) in glyphs for char in printable(text))


@given(text=st.text(max_size=60), width=st.floats(20, 200))
def test_text_fits(text: str, width: float) -> None:
    shown, size = fit(text, 4.0, width)
    assert pdfmetrics.stringWidth(shown, FONT, size) <= width + 1e-9
    assert 2.4 - 1e-9 <= size <= 4.0
