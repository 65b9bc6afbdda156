"""Numba, for the loops of coding that are sequential by nature.

Importing Numba costs half a second, so that only modules with compiled loops import this one, and
they are imported where they are first needed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


# Sums may be taken in any order and products fused; NaN and infinity keep their meaning.
_FREE_ORDER = {"contract", "arcp", "reassoc", "nsz"}


def jit(function: Function) -> Function:
    """Compile on first call; keep the machine code on disk where a folder for it can be written.

    Numba writes beside the source, else to the user's cache folder (``NUMBA_CACHE_DIR`` overrides
    both); where neither can be written, every process compiles anew.
    """
    return _compiled(function)


def fast_jit(function: Function) -> Function:
    """As `jit`, for measurements: rounding may differ from processor to processor."""
    return _compiled(function, fastmath=_FREE_ORDER, error_model="numpy")


def _compiled(function: Function, **options: Any) -> Function:
    try:
        return cast(Function, numba.njit(cache=True, nogil=True, **options)(function))
    except RuntimeError:
        return cast(Function, numba.njit(nogil=True, **options)(function))
