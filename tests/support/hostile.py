"""Inputs that no program should send, and every one may get."""

from __future__ import annotations

import json
from typing import Any

#: In forms, addresses and headers; in JSON, too.
TEXTS = (
    "",
    " ",
    "\x00",
    "a\x1b[31mb",
    "x" * 3000,
    "x y " * 700,
    "../../etc/passwd",
    "\u202e\u0301",
    "=1+1",
    "null",
    "[]",
    "%00",
    "NaN",
    "-inf",
    "1e400",
    "5e-324",
    "9" * 401,
    "-1",
    "18446744073709551616",
    "\U0001d7d9",
    "yes",
    "1",
)
#: As they stand in JSON.
TOKENS = (
    *("NaN", "-Infinity", "1e400", "5e-324", "-5e-324", "1e308", "-1e308", "9" * 401, "9" * 5000),
    *("0", "-0.0", "-1", "0.5", "18446744073709551616", "true", "null", "[]", "{}", '"5"'),
    *('""', '"\\u0000"', '"\\ud800"', json.dumps("x" * 3000), json.dumps("x y " * 700)),
    *('["\\udfff"]', '{"\\ud800": {"\\u0000": 1}}', "[" * 60 + "]" * 60, '[[1, "x"], null]'),
)
#: As they stand in JSON, in one field of a request.
FIELD_TOKENS = (
    *(
        "NaN",
        "1e400",
        "5e-324",
        "-1e308",
        "9" * 401,
        "true",
        "null",
        "[]",
        json.dumps('!!bool "x"'),
    ),
    *('"a\\u0000"', '"a\\u001bb"', '"\\ud800"', '{"\\ud800": {"\\u0000": 1}}'),
    *(json.dumps("x y " * 700), "[" * 500 + "]" * 500, "[" + "0," * 1000 + "0]"),
)
#: As texts of forms and addresses.
FIELD_TEXTS = (
    *("", "a\x00", "a\x1bb", "\ud800", "x" * 3000, "../../etc/passwd", "-inf", "5e-324", "9" * 401),
    '!!bool "x"',
)
#: What a flag is not, as text and in JSON.
NO_FLAGS = ("yes", "1", "0", "on", "t", "")
NO_FLAG_TOKENS = ('"yes"', "1", "0", '"true"', '"on"', "1.0")

_PAD: dict[str, Any] = {
    "format": "padstudio.pad",
    "version": 1,
    "window": 2,
    "levels": 2,
    "layers": [{"channel": "red", "cell_mm": 10, "codes": ["001", "011", "110"]}],
}
_CAMERA = (
    "image_width: 640\nimage_height: 480\ncamera_name: {name}\ndistortion_model: plumb_bob\n"
    "camera_matrix: {{rows: 3, cols: 3, data: [{focal}, 0, 320, 0, {focal}, 240, 0, 0, 1]}}\n"
    "distortion_coefficients: {{rows: 1, cols: 5, data: [{first}, 0, 0, 0, 0]}}\n"
)


def _pads() -> dict[str, bytes]:
    """Pad files, each with one fault."""
    found = {}
    for key in (*_PAD, "name", "scale", "quiet_mm", "seed", "distance", "unique", "crosstalk"):
        for number, token in enumerate(TOKENS):
            text = json.dumps({**_PAD, key: "TOKEN"}).replace('"TOKEN"', token)
            found[f"pad-{key}-{number}.json"] = text.encode()
    for number, token in enumerate(TOKENS):
        text = json.dumps(_PAD).replace('"cell_mm": 10', f'"cell_mm": {token}')
        found[f"pad-cell-{number}.json"] = text.encode()
    return found


def _cameras() -> dict[str, bytes]:
    values = {"name": "c", "focal": "500", "first": "0"}
    odd = (
        *('!!bool "x"', '!!int ""', "!!python/object:os.system x", "&a 5", "*a", "9" * 401),
        *("5e-324", "1e308", ".nan", ".inf", '"\\ud800"', '"\\u0000"', "~", "[]", "0x10", "1:2:3"),
        *("[" * 5000, "{" * 5000, '"' + "x" * 3000 + '"', "!!timestamp x", "? x", "2020-13-45"),
    )
    found = {
        f"camera-{key}-{number}.yaml": _CAMERA.format(**{**values, key: word}).encode()
        for key in values
        for number, word in enumerate(odd)
    }
    bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"{new}: &{new} [{', '.join(['*' + old] * 9)}]\n"
        for old, new in zip("abcdefgh", "bcdefghi", strict=True)
    )
    return found | {
        "bomb.yaml": bomb.encode(),
        "keys.yaml": b"".join(b"k%d: {a: [1, 2]}\n" % number for number in range(6000)),
        "deep.yaml": b"- " * 30_000,
        "entities.xml": b'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>',
        "cut.xml": b"<?xml version='1.0'?><opencv_storage><a",
    }


#: Names and contents.
FILES: dict[str, bytes] = {
    **_pads(),
    **_cameras(),
    "empty": b"",
    "nul.json": b"\x00" * 100,
    "noise.bin": bytes(range(256)) * 8,
    "surrogate.json": b'{"a": "\xed\xa0\x80"}',
    "deep.json": b"[" * 20_000,
    "digits.json": b'{"a": ' + b"9" * 5000 + b"}",
    "wide.csv": b"1," * 20_000,
    "odd.csv": b"time_s,north_m\n1e400,nan\n\x00,\xff\n",
    "cut.png": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + b"\xff" * 8 + b"\x08\x02\x00\x00\x00",
    "cut.jpg": b"\xff\xd8\xff\xe0\x00\x10JFIF\x00" + b"\xff" * 50,
    "cut.zip": b"PK\x03\x04" + b"\xff" * 60,
    "cut.npy": b"\x93NUMPY\x01\x00v\x00{'descr': '|O', 'fortran_order': False, 'shape': (9,)}",
    "cut.ulg": b"ULog\x01\x12\x35\x01" + b"\xff" * 60,
    "cut.bin": b"\xa3\x95\x80\x80\x59" + b"\xff" * 90,
    "cut.tlog": b"\x00" * 8 + b"\xfd\xff\x00\x00" + b"\x01" * 60,
    "odd.srt": b"1\n99:99:99,999 --> 00:00:00,000\n[rel_alt: 1e400 abs_alt: x]\n\n",
}
