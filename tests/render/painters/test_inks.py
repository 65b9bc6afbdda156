from __future__ import annotations

import pytest

from padstudio.render.painters.inks import fill_operator, stroke_operator, to_cmyk


@pytest.mark.parametrize(
    ("rgb", "cmyk"),
    [
        ((0, 0, 0), (0, 0, 0, 1)),
        ((255, 255, 255), (0, 0, 0, 0)),
        ((255, 0, 0), (0, 1, 1, 0)),
        ((0, 0, 255), (1, 1, 0, 0)),
        ((255, 0, 255), (0, 1, 0, 0)),
        ((51, 51, 51), (0, 0, 0, 0.8)),
    ],
)
def test_inks_of_the_pads_colours(rgb: tuple[int, ...], cmyk: tuple[float, ...]) -> None:
    assert to_cmyk(rgb) == pytest.approx(cmyk)


def test_operators() -> None:
    assert fill_operator((255, 0, 51), "rgb") == "1 0 0.2 rg"
    assert fill_operator((255, 0, 0), "cmyk") == "0 1 1 0 k"
    assert stroke_operator((0, 0, 0), "cmyk") == "0 0 0 1 K"
