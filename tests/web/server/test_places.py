"""How many event streams there may be."""

from __future__ import annotations

import pytest

from padstudio.errors import BusyError
from padstudio.web.server.places import Places


def test_places_are_given_back_whatever_happens() -> None:
    places = Places(1)
    for _ in range(3):
        with pytest.raises(ZeroDivisionError), places.taken():
            raise ZeroDivisionError
    with places.taken(), pytest.raises(BusyError) as caught, places.taken():
        raise AssertionError
    assert (caught.value.error_code, caught.value.status) == ("too_many_streams", 503)
    with places.taken():
        pass
