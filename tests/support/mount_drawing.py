"""The drawing of docs/live.md of how a camera is mounted, by the program's own mount."""

from __future__ import annotations

from xml.sax.saxutils import escape

import numpy as np
from places import ROOT

from padstudio.autopilot.vehicle import Mount

FILE = ROOT / "docs" / "images" / "mounting.svg"
_TURNED_DEG, _LEAN_DEG = 35.0, (25.0, 15.0)
_OFFSET_M = (0.10, 0.07, 0.06)
# Pixels a metre, of the vehicle and the camera.
_SCALE = 620
_PANEL, _HEIGHT = 300, 330
_INK, _FAINT, _CAMERA, _VEHICLE = "#1f2937", "#6b7280", "#b45309", "#d1d5db"


class _Panel:
    """One view; its axes are two of the body's."""

    def __init__(self, place: int, title: str, right: str, down: str, centre: tuple[int, int]):
        self.right, self.down = "xyz".index(right[-1]), "xyz".index(down[-1])
        self.signs = np.array([-1.0 if axis[0] == "-" else 1.0 for axis in (right, down)])
        self.centre = np.array(centre, float)
        self.parts = [f'<g transform="translate({place * _PANEL} 0)">']
        self.text((_PANEL / 2, 24), title, _INK, "middle", "bold")

    def at(self, body_m: object) -> np.ndarray:
        """Where a point of the body is drawn."""
        point = np.asarray(body_m, float)
        return self.centre + self.signs * point[[self.right, self.down]] * _SCALE

    def line(self, a: object, b: object, color: str, *, arrow: str = "", dash: str = "") -> None:
        (x1, y1), (x2, y2) = np.asarray(a, float), np.asarray(b, float)
        more = f' marker-end="url(#{arrow})"' if arrow else ""
        more += f' stroke-dasharray="{dash}"' if dash else ""
        ends = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
        self.parts.append(f'<line {ends} stroke="{color}"{more}/>')

    def text(
        self, at: object, text: str, color: str, anchor: str = "start", weight: str = "normal"
    ) -> None:
        x, y = np.asarray(at, float)
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" fill="{color}" text-anchor="{anchor}" '
            f'font-weight="{weight}">{escape(text)}</text>'
        )

    def shape(self, points: list[np.ndarray], fill: str, stroke: str) -> None:
        corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polygon points="{corners}" fill="{fill}" stroke="{stroke}"/>')

    def dot(self, at: np.ndarray, radius: float, fill: str, stroke: str = "none") -> None:
        self.parts.append(
            f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:g}" fill="{fill}" '
            f'stroke="{stroke}"/>'
        )

    def arc(self, at: np.ndarray, radius: float, first: np.ndarray, last: np.ndarray) -> None:
        """From one direction to another, the short way."""
        a, b = (at + radius * d / np.linalg.norm(d) for d in (first, last))
        sweep = int(first[0] * last[1] - first[1] * last[0] > 0)
        self.parts.append(
            f'<path d="M{a[0]:.1f} {a[1]:.1f} A{radius:g} {radius:g} 0 0 {sweep} '
            f'{b[0]:.1f} {b[1]:.1f}" fill="none" stroke="{_CAMERA}"/>'
        )

    def measure(self, a: np.ndarray, b: np.ndarray, text: str, at: object, anchor: str) -> None:
        """A length between two points."""
        self.line(a, b, _FAINT, arrow="end")
        self.text(at, text, _FAINT, anchor)

    def axes(self, names: tuple[str, str]) -> None:
        for which, name in enumerate(names):
            way = np.eye(2)[which] * self.signs[which]
            tip = self.centre + way * 118
            self.line(self.centre, tip, _INK, arrow="ink")
            aside = np.array([6, 4]) if which == 1 or way[0] == 0 else np.array([-38, -8])
            self.text(tip + aside, name, _INK)
        self.dot(self.centre, 4, _INK)


def _body(panel: _Panel, *, from_above: bool) -> None:
    if not from_above:
        (x, y), half = panel.centre, 62
        panel.shape(
            [np.array(p) for p in ((x - half, y - 14), (x + half, y - 14), (x + half, y + 14))]
            + [np.array((x - half, y + 14))],
            _VEHICLE,
            _FAINT,
        )
        for side in (-1, 1):
            panel.line((x + side * 62 - 26, y - 22), (x + side * 62 + 26, y - 22), _FAINT)
        return
    for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        tip = panel.centre + np.array([dx, dy]) * 74
        panel.line(panel.centre, tip, _FAINT)
        panel.dot(tip, 18, "none", _FAINT)
    panel.dot(panel.centre, 34, _VEHICLE, _FAINT)


def _from_above(mount: Mount) -> _Panel:
    panel = _Panel(0, "from above", "y", "-x", (112, 180))
    _body(panel, from_above=True)
    panel.axes(("y right", "x forward"))
    camera, corner = panel.at(mount.position_m), panel.at([mount.position_m[0], 0, 0])
    up, right = -mount.rotation[:, 1], mount.rotation[:, 0]
    sides = [panel.signs * v[[1, 0]] / np.linalg.norm(v[:2]) for v in (right, up)]
    shape = [camera + a * 11 * sides[0] + b * 8 * sides[1] for a, b in _CORNERS]
    panel.measure(panel.centre, corner, "--forward-m", corner + [-6, 22], "end")
    panel.measure(corner, camera, "--right-m", camera + [16, 22], "start")
    panel.shape(shape, "white", _CAMERA)
    panel.line(camera, camera + 60 * sides[1], _CAMERA, arrow="camera")
    panel.text(camera + 60 * sides[1] + [6, -4], "up in the picture", _CAMERA)
    panel.line(camera, camera + [0, -50], _CAMERA, dash="3 3")
    panel.arc(camera, 38, np.array([0.0, -1.0]), sides[1])
    panel.text(camera + [53, -18], "--turned-deg", _CAMERA)
    return panel


def _from_a_side(
    mount: Mount, place: int, title: str, axis: str, option: str, along: str
) -> _Panel:
    panel = _Panel(place, title, axis, "z", (110, 110))
    _body(panel, from_above=False)
    panel.axes((f"{axis} {along}", "z down"))
    which = panel.right
    camera = panel.at(mount.position_m)
    beside = panel.at(np.eye(3)[which] * mount.position_m)
    panel.measure(beside, camera, "--down-m", camera + [16, -8], "start")
    look = mount.rotation[:, 2][[which, 2]]
    look /= np.linalg.norm(look)
    across = np.array([look[1], -look[0]])
    shape = [camera + a * 11 * across + b * 8 * look for a, b in _CORNERS]
    panel.shape(shape, "white", _CAMERA)
    panel.line(camera, camera + 130 * look, _CAMERA, arrow="camera")
    panel.text(camera + 130 * look + [0, 18], "optical axis", _CAMERA, "middle")
    panel.line(camera, camera + [0, 125], _CAMERA, dash="3 3")
    panel.arc(camera, 96, np.array([0.0, 1.0]), look)
    panel.text(camera + 100 * look + [8, 0], option, _CAMERA)
    return panel


_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


def drawing() -> str:
    """The file's content."""
    mount = Mount.leaning(_TURNED_DEG, _LEAN_DEG, np.array(_OFFSET_M))
    panels = [
        _from_above(mount),
        _from_a_side(mount, 1, "from the right", "x", "--lean-forward-deg", "forward"),
        _from_a_side(mount, 2, "from behind", "y", "--lean-right-deg", "right"),
    ]
    arrows = "".join(
        f'<marker id="{name}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" '
        f'markerHeight="7" orient="auto"><path d="M0 1 L10 5 L0 9 z" fill="{color}"/></marker>'
        for name, color in (("ink", _INK), ("camera", _CAMERA), ("end", _FAINT))
    )
    width = _PANEL * len(panels)
    body = "\n".join("\n".join([*panel.parts, "</g>"]) for panel in panels)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {_HEIGHT}" '
        f'width="{width}" height="{_HEIGHT}" font-family="sans-serif" font-size="13" '
        f'stroke-width="1.5">\n<defs>{arrows}</defs>\n'
        f'<rect width="{width}" height="{_HEIGHT}" fill="white"/>\n'
        # Strokes are for lines; letters have none.
        f"<style>text {{ stroke: none }}</style>\n{body}\n</svg>\n"
    )
