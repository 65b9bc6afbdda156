"""Requests that an OpenAPI document allows, and the same with any one value instead of another."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any
from urllib.parse import quote

_BOUNDARY = "a-boundary-of-tests"
_JSON, _FORM = "application/json", "multipart/form-data"


@dataclass(frozen=True)
class Place:
    """Where a value stands in a request.

    Attributes
    ----------
    kind : {"path", "query", "header", "form", "json"}
    steps : tuple of str or int
        A name; in JSON, names and numbers from the outermost to the value's own.
    """

    kind: str
    steps: tuple[str | int, ...]

    @property
    def name(self) -> str:
        """For people."""
        return f"{self.kind} {'.'.join(map(str, self.steps))}"


@dataclass(frozen=True)
class Request:
    """As it is sent."""

    method: str
    target: str
    headers: dict[str, str]
    body: bytes | None


@dataclass(frozen=True)
class Operation:
    """One operation, and valid values for all that it asks for.

    Attributes
    ----------
    name, method, path : str
    values : dict
        Valid values by place; JSON's are of required and of exemplary fields alone.
    places : list of Place
        Every place where a value may stand.
    media : str or None
        What its body is sent as.
    body : object
        A valid body of JSON.
    """

    name: str
    method: str
    path: str
    values: dict[Place, Any]
    places: list[Place]
    media: str | None
    body: Any = field(default=None)

    def request(self, at: Place | None = None, value: str = "") -> Request:
        """A valid request, or one with a value in a place.

        Parameters
        ----------
        at : Place, optional
        value : str
            Text; in JSON the token that stands there.
        """
        given = {place: found for place, found in self.values.items() if place != at}
        if at is not None and at.kind != "json":
            given[at] = value
        path, query = self.path, []
        headers, form = {}, []
        for place, found in given.items():
            (name,) = place.steps
            if place.kind == "path":
                path = path.replace(f"{{{name}}}", _quoted(found))
            elif place.kind == "query":
                query.append(f"{name}={_quoted(found)}")
            elif place.kind == "header":
                headers[str(name)] = _text(found)
            else:
                form.append(_part(str(name), found))
        body: bytes | None = None
        if self.media == _JSON:
            headers["Content-Type"] = _JSON
            steps = at.steps if at is not None and at.kind == "json" else None
            body = _json(self.body, steps, value)
        elif self.media == _FORM:
            headers["Content-Type"] = f"{_FORM}; boundary={_BOUNDARY}"
            body = b"".join(form) + f"--{_BOUNDARY}--\r\n".encode()
        elif self.media is not None:
            headers["Content-Type"], body = self.media, b""
        return Request(self.method, path + ("?" + "&".join(query) if query else ""), headers, body)


def operations(document: Mapping[str, Any], known: Mapping[str, Any]) -> dict[str, Operation]:
    """All operations of a document by name; one whose body is of several kinds is there for each.

    Parameters
    ----------
    document : mapping
    known : mapping
        Values of what exists, by a parameter's or field's name, or by ``operation.name``; they come
        before the document's own examples.
    """
    found = {}
    for path, item in document["paths"].items():
        for method, described in item.items():
            made = _Reader(document["components"]["schemas"], described["operationId"], known)
            for kind, of_kind in _by_kind(described):
                name = f"{described['operationId']} {kind}".strip()
                found[name] = replace(made.operation(method.upper(), path, of_kind), name=name)
    return found


def _by_kind(described: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """An operation's description for each kind of its body."""
    kinds = described.get("requestBody", {}).get("content", {}).get(_JSON, {}).get("schema", {})
    if "oneOf" not in kinds:
        yield "", described
    for schema in kinds.get("oneOf", ()):
        body = {"content": {_JSON: {"schema": schema}}}
        yield schema["$ref"].rpartition("/")[2], {**described, "requestBody": body}


class _Reader:
    """Reads one operation's description."""

    def __init__(self, schemas: Mapping[str, Any], name: str, known: Mapping[str, Any]) -> None:
        self._schemas, self._name, self._known = schemas, name, known

    def operation(self, method: str, path: str, described: Mapping[str, Any]) -> Operation:
        values: dict[Place, Any] = {}
        places = []
        for parameter in described.get("parameters", ()):
            place = Place(parameter["in"], (parameter["name"],))
            places.append(place)
            if parameter.get("required") or f"{self._name}.{parameter['name']}" in self._known:
                values[place] = self._valid(parameter["schema"], parameter["name"])
        media, body = None, None
        for media, content in described.get("requestBody", {}).get("content", {}).items():
            if media == _JSON:
                body = self._valid(content["schema"], "")
                places += [Place("json", steps) for steps in self._steps(content["schema"], body)]
            elif media == _FORM:
                schema = self._whole(content["schema"])
                for name, part in schema["properties"].items():
                    places.append(Place("form", (name,)))
                    if name in schema.get("required", ()):
                        values[places[-1]] = self._valid(part, name)
        return Operation(self._name, method, path, values, places, media, body)

    def _whole(self, schema: Mapping[str, Any]) -> Mapping[str, Any]:
        """What a schema says, without references and null."""
        while "$ref" in schema:
            schema = self._schemas[schema["$ref"].rpartition("/")[2]]
        kinds = [kind for kind in schema.get("anyOf", ()) if kind != {"type": "null"}]
        return {**schema, **self._whole(kinds[0])} if kinds else schema

    def _valid(self, schema: Mapping[str, Any], name: str) -> Any:
        """A valid value."""
        for key in (f"{self._name}.{name}", name):
            if key in self._known:
                return self._known[key]
        schema = self._whole(schema)
        if schema.get("type") == "object" or "properties" in schema:
            example = {**(schema.get("examples") or [{}])[0]}
            fields = schema.get("properties", {})
            asked = [key for key in fields if key in schema.get("required", ()) or key in example]
            known = [key for key in asked if key in self._known]
            known += [key for key in fields if f"{self._name}.{key}" in self._known]
            missing = [key for key in asked if key not in example]
            return example | {key: self._valid(fields[key], key) for key in (*missing, *known)}
        if schema.get("examples"):
            return schema["examples"][0]
        if schema.get("default") is not None:
            return schema["default"]
        for key in ("const", "enum"):
            if key in schema:
                return schema[key] if key == "const" else schema[key][0]
        if schema.get("type") == "array":
            return [self._valid(schema["items"], "")] * schema.get("minItems", 1)
        if schema.get("type") in ("integer", "number"):
            return max(schema.get("minimum", 1), min(1, schema.get("maximum", 1)))
        return "none"

    def _steps(
        self, schema: Mapping[str, Any], example: Any, before: tuple[str | int, ...] = ()
    ) -> Iterator[tuple[str | int, ...]]:
        """To every value of a body; of lists to the first, of free objects to what is exemplary."""
        schema = self._whole(schema)
        if before:
            yield before
        if "properties" in schema:
            for name, part in schema["properties"].items():
                inner = example.get(name) if isinstance(example, dict) else None
                yield from self._steps(part, inner, (*before, name))
        elif schema.get("type") == "array" and "items" in schema:
            inner = example[0] if isinstance(example, list) and example else None
            yield from self._steps(schema["items"], inner, (*before, 0))
        elif isinstance(example, dict):
            for name, inner in example.items():
                yield from self._steps({}, inner, (*before, name))


def _json(body: Any, steps: tuple[str | int, ...] | None, token: str) -> bytes:
    """A body of JSON with a token in a place; what leads there is made where it is missing."""
    if steps is None:
        return json.dumps(body).encode()
    whole: Any = json.loads(json.dumps(body))
    inner = whole
    for step, following in zip(steps, (*steps[1:], None), strict=True):
        if isinstance(step, int):
            inner = inner if isinstance(inner, list) else []
            inner[:] = inner or [None]
        if following is None:
            inner[step] = "THE TOKEN"
        else:
            kind = list if isinstance(following, int) else dict
            if not isinstance(inner[step] if isinstance(step, int) else inner.get(step), kind):
                inner[step] = kind()
            inner = inner[step]
    return json.dumps(whole).replace('"THE TOKEN"', token).encode("utf-8", "surrogatepass")


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _quoted(value: Any) -> str:
    return quote(_text(value).encode("utf-8", "surrogatepass"), safe="")


def _part(name: str, value: Any) -> bytes:
    """A part of a form: a file where its value is bytes; of a list, one part for each."""
    if isinstance(value, list):
        return b"".join(_part(name, item) for item in value)
    data = value if isinstance(value, bytes) else _text(value).encode("utf-8", "surrogatepass")
    file = '; filename="a.png"' if isinstance(value, bytes) else ""
    head = f'--{_BOUNDARY}\r\nContent-Disposition: form-data; name="{name}"{file}\r\n\r\n'
    return head.encode() + data + b"\r\n"
