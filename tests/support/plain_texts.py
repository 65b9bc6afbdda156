"""Texts as `padstudio.text.plain` has them, for properties."""

from __future__ import annotations

import unicodedata

from hypothesis import strategies as st


def plain_texts(most: int) -> st.SearchStrategy[str]:
    """Texts of so many characters at the most, composed, without control characters."""
    characters = st.characters(exclude_categories=("Cc", "Cs"))
    composed = st.text(characters, max_size=most).map(
        lambda text: unicodedata.normalize("NFC", text)
    )
    return composed.filter(lambda text: len(text) <= most)
