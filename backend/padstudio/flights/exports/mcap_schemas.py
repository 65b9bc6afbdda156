"""JSON Schemas of the Foxglove messages that the MCAP export writes, under Foxglove's names."""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]


def _object(**properties: Schema) -> Schema:
    return {"type": "object", "properties": properties, "required": list(properties)}


def _list(items: Schema, count: int | None = None) -> Schema:
    exact = {} if count is None else {"minItems": count, "maxItems": count}
    return {"type": "array", "items": items} | exact


_NUMBER: Schema = {"type": "number"}
_INTEGER: Schema = {"type": "integer"}
_TEXT: Schema = {"type": "string"}
_TIME = _object(sec=_INTEGER, nsec=_INTEGER)
_VECTOR3 = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_POINT2 = _object(x=_NUMBER, y=_NUMBER)
_COLOR = _object(r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_POINTS = _object(
    timestamp=_TIME,
    type=_INTEGER,
    points=_list(_POINT2),
    outline_color=_COLOR,
    outline_colors=_list(_COLOR),
    fill_color=_COLOR,
    thickness=_NUMBER,
)
_LABEL = _object(
    timestamp=_TIME,
    position=_POINT2,
    text=_TEXT,
    font_size=_NUMBER,
    text_color=_COLOR,
    background_color=_COLOR,
)

_RANGE_BEARING = _object(
    timestamp=_TIME, frame_id=_TEXT, range=_NUMBER, bearing=_VECTOR3, quality=_TEXT
)
# Left out where they are not known.
_RANGE_BEARING["properties"] |= {"range_sigma": _NUMBER, "bearing_sigma_deg": _NUMBER}

#: Lengths are metres; annotations count pixels from the corner of the top-left pixel.
SCHEMAS: dict[str, Schema] = {
    "foxglove.CompressedImage": _object(
        timestamp=_TIME,
        frame_id=_TEXT,
        data={"type": "string", "contentEncoding": "base64"},
        format=_TEXT,
    ),
    "foxglove.CameraCalibration": _object(
        timestamp=_TIME,
        frame_id=_TEXT,
        width=_INTEGER,
        height=_INTEGER,
        distortion_model=_TEXT,
        D=_list(_NUMBER),
        K=_list(_NUMBER, 9),
        R=_list(_NUMBER, 9),
        P=_list(_NUMBER, 12),
    ),
    "foxglove.FrameTransform": _object(
        timestamp=_TIME,
        parent_frame_id=_TEXT,
        child_frame_id=_TEXT,
        translation=_VECTOR3,
        rotation=_QUATERNION,
    ),
    "foxglove.PoseInFrame": _object(
        timestamp=_TIME,
        frame_id=_TEXT,
        pose=_object(position=_VECTOR3, orientation=_QUATERNION),
    ),
    "padstudio.RangeBearing": _RANGE_BEARING,
    "foxglove.ImageAnnotations": _object(
        circles=_list(_object()), points=_list(_POINTS), texts=_list(_LABEL)
    ),
}
for _name, _schema in SCHEMAS.items():
    _schema["title"] = _name
