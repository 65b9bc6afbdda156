"""Texts from outside: names, notes, addresses. They have one form, and hold nothing but text."""

from __future__ import annotations

import re
import unicodedata

# No program shows control characters; halves of surrogate pairs cannot be written as UTF-8 at all.
_NO_TEXT = re.compile("[\x00-\x1f\x7f-\x9f\ud800-\udfff]")


def plain(text: str) -> str:
    """A text in Unicode's composed form (NFC).

    Raises
    ------
    ValueError
        If it holds a control character or half a surrogate pair, with a sentence that says where.
    """
    odd = _NO_TEXT.search(text)
    if odd:
        raise ValueError(
            f"character {odd.start()} (U+{ord(odd[0]):04X}) is no text; leave control characters "
            "and halves of surrogate pairs out"
        )
    return unicodedata.normalize("NFC", text)


def is_plain(text: str) -> bool:
    """True where `plain` takes a text."""
    return _NO_TEXT.search(text) is None
