import pytest

from padstudio.errors import CameraFormatError
from padstudio.geometry import plain_text


def parse(text):
    return plain_text.parse(text.encode(), "c.yaml")


def test_opencvs_first_line_and_tag_are_known():
    text = "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 1\n   data: [ 1., 2. ]\n"
    assert parse(text) == {"K": {"rows": 1, "data": [1.0, 2.0]}}


def test_a_byte_order_mark_does_not_count():
    assert plain_text.parse(b'\xef\xbb\xbf{"a": 1}', "c.json") == {"a": 1}
    assert plain_text.parse(b"\xef\xbb\xbfa: 1", "c.yaml") == {"a": 1}


@pytest.mark.parametrize(
    "text",
    [
        "a: !!python/object/apply:os.system ['true']",
        "!!python/name:os.system",
        "a: !!python/tuple [1]",
        "a: !local 3",
    ],
)
def test_tags_that_could_execute_are_refused(text):
    with pytest.raises(CameraFormatError, match="line 1: could not determine a constructor"):
        parse(text)


def test_aliases_are_refused_before_they_expand():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30)]
    with pytest.raises(CameraFormatError, match="line 2: aliases are not read"):
        parse("\n".join(lines))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("%YAML:1.0\n---\na: [1, 2\nb: 3", "ill-formed YAML: line 4"),
        ("a: 'open", "ill-formed YAML: line 1"),
        ("a: 1\n--- \nb: 2", "ill-formed YAML"),
        ("a: \x00", "ill-formed YAML"),
        ('{"a": [1, 2}', "ill-formed JSON.*line 1 column 12"),
        ("[" * 100_000, "ill-formed JSON"),
        ("a: " + "[" * 5_000, "ill-formed YAML"),
        ("2020-99-99: x", "ill-formed YAML: month must be in 1"),
    ],
)
def test_ill_formed_text_is_refused_with_its_place(text, message):
    with pytest.raises(CameraFormatError, match=message):
        parse(text)


def test_bytes_that_are_no_text_are_refused():
    with pytest.raises(CameraFormatError, match=r"c\.yaml: byte 2 is no UTF-8 text"):
        plain_text.parse(b"a:\xff", "c.yaml")


def test_files_beyond_the_limit_are_not_parsed():
    with pytest.raises(CameraFormatError, match="a camera file has at most 100000"):
        parse("a: " + "x" * plain_text.MAX_YAML_BYTES)
    with pytest.raises(CameraFormatError, match="a camera file has at most 32000000"):
        plain_text.parse(b"[" + b" " * plain_text.MAX_JSON_BYTES, "c.json")
