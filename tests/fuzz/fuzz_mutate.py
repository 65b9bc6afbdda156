"""Makes other files of known ones: bytes, words and lines changed, doubled, cut and mixed."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Sequence

import hostile

#: Longer files are cut: what a reader does with many bytes, it does with few.
MOST_BYTES = 8_000
_WORD = re.compile(rb"[\w.+-]+")
_BYTES = (0, 1, 9, 10, 13, 32, 34, 44, 58, 91, 93, 123, 125, 127, 128, 255)
_ODD = [token.encode("utf-8", "surrogatepass") for token in (*hostile.TOKENS, *hostile.TEXTS)]
_ODD += [b"!!int x", b"&a ", b"*a", b"<<: *a", b"? ", b"---\n", b".inf", b".nan", b"0x10", b"1_0"]
_ODD += [b"\xef\xbb\xbf", b"\xff\xfe", b"\xed\xa0\x80", b"\n", b"\t", b"%YAML 1.2\n", b"1e-320"]
_ODD = [word[:600] for word in _ODD]


def mutated(data: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    """One to several changes of a file, in which parts of others may come."""
    for _ in range(chance.choice((1, 1, 1, 2, 3, 6))):
        data = chance.choice(_CHANGES)(data, others, chance)
    return data[:MOST_BYTES]


_Change = Callable[[bytes, Sequence[bytes], random.Random], bytes]


def _byte(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    if not data:
        return bytes([chance.choice(_BYTES)])
    at = chance.randrange(len(data))
    new = chance.choice((chance.choice(_BYTES), chance.randrange(256), data[at] ^ 1 << at % 8))
    return data[:at] + bytes([new]) + data[at + 1 :]


def _number(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    """Two or four bytes to a length or count at the ends of its range."""
    size = chance.choice((2, 4, 8))
    if len(data) < size:
        return data
    at = chance.randrange(len(data) - size + 1)
    value = chance.choice((0, 1, 127, 255, 2 ** (8 * size - 1), 2 ** (8 * size) - 1, len(data)))
    return data[:at] + value.to_bytes(size, chance.choice(("big", "little"))) + data[at + size :]


def _word(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    words = list(_WORD.finditer(data))
    if not words:
        return data
    word = chance.choice(words)
    return data[: word.start()] + chance.choice(_ODD) + data[word.end() :]


def _swap(data: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    """A word of another file in place of one."""
    words = list(_WORD.finditer(data))
    theirs = _WORD.findall(chance.choice(others))
    if not words or not theirs:
        return data
    word = chance.choice(words)
    return data[: word.start()] + chance.choice(theirs) + data[word.end() :]


def _insert(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    at = chance.randint(0, len(data))
    return data[:at] + chance.choice(_ODD) + data[at:]


def _cut(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    start, end = sorted(chance.randint(0, len(data)) for _ in range(2))
    return data[:start] + data[end:] if chance.random() < 0.7 else data[:end]


def _double(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    start, end = sorted(chance.randint(0, len(data)) for _ in range(2))
    return data[:end] + data[start:end] * chance.choice((1, 2, 5)) + data[end:]


def _lines(data: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    """A line left out, doubled, moved, or taken from another file."""
    lines = data.splitlines(keepends=True)
    theirs = chance.choice(others).splitlines(keepends=True) or [b"\n"]
    if not lines:
        return theirs[0]
    at = chance.randrange(len(lines))
    line = chance.choice((lines[at], chance.choice(theirs)))
    if chance.random() < 0.4:
        lines.pop(at)
    lines.insert(chance.randint(0, len(lines)), line)
    return b"".join(lines)


def _splice(data: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    other = chance.choice(others)
    return data[: chance.randint(0, len(data))] + other[chance.randint(0, len(other)) :]


_CHANGES: tuple[_Change, ...] = (
    *(_byte, _number, _word, _word, _word, _swap, _swap),
    *(_insert, _cut, _double, _lines, _lines, _splice),
)
