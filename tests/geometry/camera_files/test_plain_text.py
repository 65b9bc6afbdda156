import json

import pytest

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts import plain_text, xml_text, yaml_text


def parse(text):
    return plain_text.yaml_values(text)


def test_opencvs_first_line_and_tag_are_known():
    text = "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 1\n   data: [ 1., 2. ]\n"
    assert parse(text) == {"K": {"rows": 1, "data": [1.0, 2.0]}}


def test_plain_values_are_yamls():
    text = "a: 1\nb: [1.5, -2e3, .5, 1e-3, .inf]\nc: yes\nd: ~\ne: '1'\nf: 2020-99-99\nno: x"
    assert parse(text) == {
        "a": 1,
        "b": [1.5, -2000.0, 0.5, 0.001, float("inf")],
        "c": True,
        "d": None,
        "e": "1",
        "f": "2020-99-99",
        "no": "x",
    }


def test_the_first_of_several_documents_is_read():
    assert parse("a: 1\n---\nb: 2") == {"a": 1}
    assert parse("---\na: 1\n---\nb: [cut off") == {"a": 1}
    assert parse("a: 1\n---\n") == {"a": 1}


@pytest.mark.parametrize(
    "text",
    [
        "a: !!python/object/apply:os.system ['true']",
        "!!python/name:os.system",
        "a: !!python/tuple [1]",
        "a: !local 3",
        'a: !!int ""',
        'a: !!bool "x"',
        'a: !!timestamp "x"',
        "a: !!binary x",
        "!!set {a, b}",
    ],
)
def test_tags_are_refused(text):
    with pytest.raises(CameraFormatError, match=r"line 1: the tag .* is not read"):
        parse(text)


def test_aliases_are_refused_before_they_expand():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30)]
    with pytest.raises(CameraFormatError, match="line 2: aliases are not read"):
        parse("\n".join(lines))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("%YAML:1.0\n---\na: [1, 2\nb: 3", "ill-formed YAML: line"),
        ("a: 'open", "ill-formed YAML: line"),
        ("a: \x00", "ill-formed YAML"),
        ("a: " + "[" * 5_000, "nested more than 32 deep"),
        ("a: 1\nb: 2\na: 3", "line 3: a stands twice"),
        ("? [a]\n: 1", "line 1: a key must be a text"),
    ],
)
def test_ill_formed_yaml_is_refused_with_its_place(text, message):
    with pytest.raises(CameraFormatError, match=message):
        parse(text)


def test_both_parsers_of_yaml_give_the_same(monkeypatch):
    text = "%YAML:1.0\n---\na: {b: [1, 'x', ~], c: !!opencv-matrix {rows: 1}}\nd: |\n  text\n"
    in_c = parse(text)
    monkeypatch.setattr(yaml_text, "_LOADER", __import__("yaml").SafeLoader)
    assert parse(text) == in_c == {"a": {"b": [1, "x", None], "c": {"rows": 1}}, "d": "text\n"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"a": [1, 2}', "ill-formed JSON.*line 1 column 12"),
        ("[" * 100_000, "ill-formed JSON"),
        ('{"a": 1, "a": 2}', "a stands twice"),
    ],
)
def test_ill_formed_json_is_refused_with_its_place(text, message):
    with pytest.raises(CameraFormatError, match=message):
        plain_text.json_values(text)


def test_pictures_in_json_are_left_out_and_the_rest_is_bounded():
    picture = "A" * (plain_text.MAX_JSON_VALUES_BYTES + 1)
    values = {"a": [1, "b"], "picture": picture}
    assert plain_text.json_values(json.dumps(values)) == {"a": [1, "b"], "picture": ""}
    with pytest.raises(CameraFormatError, match="besides its pictures"):
        plain_text.json_values("[" + "1," * (plain_text.MAX_JSON_VALUES_BYTES // 2) + "1]")


def test_encodings():
    assert plain_text.decode(b'\xef\xbb\xbf{"a": 1}', 100) == '{"a": 1}'
    assert plain_text.decode("a: ü\r\n".encode("utf-16"), 100) == "a: ü\n"
    assert plain_text.decode(b"a: f\xe9vr.", 100) == "a: févr."
    with pytest.raises(CameraFormatError, match="character 2 is no text"):
        plain_text.decode(b"a:\x02", 100)
    with pytest.raises(CameraFormatError, match="a camera file has at most 4"):
        plain_text.decode(b"a: 12", 4)


def test_xml():
    text = b"<r><a>1 2</a><b><_>3</_><_>4</_></b><c type_id='x'><d>\"t u\"</d></c><e/></r>"
    values = {"a": "1 2", "b": ["3", "4"], "c": {"d": "t u"}, "e": None}
    assert xml_text.parse(text) == ("r", values)
    for wrong, message in (
        (b"<!DOCTYPE r [<!ENTITY a 'b'>]><r>&a;</r>", "document type"),
        (b"<r><a>1</a><a>2</a></r>", "a stands twice"),
        (b"<r><a k1='2'>1</a></r>", "the attribute k1 of a"),
        (b"<r><a>", "ill-formed XML"),
        (b"<a>" * 40 + b"</a>" * 40, "nested more than"),
    ):
        with pytest.raises(CameraFormatError, match=message):
            xml_text.parse(wrong)
