"""Numba's settings for the simulator's inner loop."""

from __future__ import annotations

from typing import Any

import numba as nb

# Nothing in the loop allocates. With Numba's run time on, every call counts its arrays' references
# atomically: four times the time on one thread, more on several.
_options: dict[str, Any] = {"nogil": True, "cache": True, "error_model": "numpy", "_nrt": False}
compiled = nb.njit(**_options)
inlined = nb.njit(forceinline=True, **_options)
