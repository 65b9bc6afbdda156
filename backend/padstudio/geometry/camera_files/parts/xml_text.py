"""XML as plain values: OpenCV's FileStorage, and flat lists of elements."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

from padstudio.errors import CameraFormatError

_DEEPEST = 32


def parse(data: bytes) -> tuple[str, dict[str, Any]]:
    """The root element's name, and its elements' values by name.

    An element's value is a mapping of its elements, a list where they are called ``_``, a list of
    words where its text has several, else its text; an attribute other than OpenCV's ``type_id``
    is refused where an element has one.

    Raises
    ------
    CameraFormatError
        If it is ill-formed, has a document type or says an element twice.
    """
    if re.search(rb"<!(DOCTYPE|ENTITY)", data):
        raise CameraFormatError("XML with a document type is not read; remove it")
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise CameraFormatError(f"ill-formed XML: {error}") from error
    value = _value(root, 0)
    return root.tag, value if isinstance(value, dict) else {}


def _value(element: ElementTree.Element, depth: int) -> Any:
    if depth > _DEEPEST:
        raise CameraFormatError(f"XML nested more than {_DEEPEST} deep is not read")
    odd = [name for name in element.attrib if name != "type_id"]
    if depth and odd:
        raise CameraFormatError(f"the attribute {odd[0]} of {element.tag} is not known; remove it")
    children = list(element)
    if not children:
        return _text(element.text or "")
    if all(child.tag == "_" for child in children):
        return [_value(child, depth + 1) for child in children]
    values: dict[str, Any] = {}
    for child in children:
        if child.tag in values:
            raise CameraFormatError(f"{child.tag} stands twice; leave one")
        values[child.tag] = _value(child, depth + 1)
    return values


def _text(text: str) -> Any:
    text = text.strip()
    if len(text) > 1 and text[0] == text[-1] == '"':
        return text[1:-1]
    return text or None
