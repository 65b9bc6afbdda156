"""The one door to compiled loops: Numba is imported when the first of them is called.

Modules with loops can be imported freely: importing Numba, which costs more than all other imports
together, waits for the first call. Machine code is kept on disk, in a folder named by a hash of the
sources of *all* loops: Numba by itself notices changes of a loop's own file only, and would go on
calling old code of a loop in another file.
"""

from __future__ import annotations

import gc
import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

_PACKAGE = Path(__file__).parent
# Sums may be taken in any order and products fused; NaN and infinity keep their meaning.
_FREE_ORDER = {"contract", "arcp", "reassoc", "nsz"}
_FOLDER = "compiled-"
# What wants to know that loops are being made ready.
_watchers: list[Callable[[bool], None]] = []
_IMPORTED = re.compile(rb"^from padstudio\.([\w.]+) import", re.MULTILINE)


class Compiled(Generic[P, T]):
    """A loop that is compiled when it is first called, from Python or from another loop.

    Parameters
    ----------
    function : callable
    **options : object
        Of `numba.njit`.
    """

    def __init__(self, function: Callable[P, T], **options: Any) -> None:
        self.__name__ = function.__name__
        self.__doc__ = function.__doc__
        self.__wrapped__ = function
        self._options = options
        self._dispatcher: Callable[P, T] | None = None

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> T:
        return (self._dispatcher or self.dispatcher)(*args, **kwargs)

    @property
    def dispatcher(self) -> Any:
        """Numba's own object, whose ``signatures`` tell what was compiled."""
        if self._dispatcher is None:
            self._dispatcher = _dispatcher(self.__wrapped__, {"nogil": True, **self._options})
        return self._dispatcher


def jit(function: Callable[P, T]) -> Compiled[P, T]:
    """Compile on first call; results are the same on every platform."""
    return Compiled(function)


def fast_jit(function: Callable[P, T]) -> Compiled[P, T]:
    """As `jit`, for measurements: rounding may differ from processor to processor."""
    return Compiled(function, fastmath=_FREE_ORDER, error_model="numpy")


def pure_jit(function: Callable[P, T]) -> Compiled[P, T]:
    """As `jit`, for loops that allocate nothing.

    With Numba's run time on, every call counts its arrays' references atomically: four times the
    time on one thread, more on several.
    """
    return Compiled(function, error_model="numpy", _nrt=False)


def inlined_jit(function: Callable[P, T]) -> Compiled[P, T]:
    """As `pure_jit`, put into its callers' code."""
    return Compiled(function, error_model="numpy", _nrt=False, forceinline=True)


def fast_inlined_jit(function: Callable[P, T]) -> Compiled[P, T]:
    """As `inlined_jit`, for measurements: rounding may differ from processor to processor."""
    options = {"fastmath": _FREE_ORDER, "_nrt": False, "forceinline": True}
    return Compiled(function, error_model="numpy", **options)


def watch_preparing(told: Callable[[bool], None]) -> None:
    """Have a function told when loops begin (True) and cease (False) to be made ready.

    It is when Numba is imported, and when a loop is loaded or compiled, that calls take longer for
    once. Calls come in pairs, which may lie within each other, from any thread.
    """
    _watchers.append(told)


def _tell(begins: bool) -> None:
    for told in _watchers:
        told(begins)


@contextmanager
def _preparing() -> Iterator[None]:
    _tell(True)
    try:
        yield
    finally:
        _tell(False)


@cache
def cache_folder() -> Path | None:
    """Where machine code is kept; None where there is no such folder and none can be made.

    Beside this module, else in the user's cache folder; the environment's ``NUMBA_CACHE_DIR``
    overrides both. A folder that was filled when the package was installed serves users who may
    only read it.
    """
    given = os.environ.get("NUMBA_CACHE_DIR")
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "padstudio"
    for parent in [Path(given)] if given else [_PACKAGE / "__pycache__", user]:
        folder = parent / f"{_FOLDER}{sources_hash()}"
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            return folder
    return None


def forget_older() -> None:
    """Remove machine code of other versions of the sources."""
    newest = cache_folder()
    for folder in newest.parent.glob(f"{_FOLDER}*") if newest else ():
        if folder != newest:
            shutil.rmtree(folder, ignore_errors=True)


@cache
def sources_hash() -> str:
    """Of every module with compiled loops, and of those whose records and constants they take."""
    sources = {path: path.read_bytes() for path in sorted(_PACKAGE.rglob("*.py"))}
    with_loops = [source for source in sources.values() if b"padstudio.compiled import" in source]
    taken = {name.decode() for source in with_loops for name in _IMPORTED.findall(source)}
    from hashlib import blake2b

    found = blake2b(digest_size=8)
    for path, source in sources.items():
        place = path.relative_to(_PACKAGE).with_suffix("").as_posix()
        if source in with_loops or place.replace("/", ".") in taken:
            found.update(place.encode() + b"\0" + source)
    return found.hexdigest()


def _dispatcher(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """Numba's object for a function, which loads or compiles its code when it is called."""
    with _preparing():
        dispatcher, folder = _numba().njit(**options)(function), cache_folder()
        if folder is not None:
            from padstudio.machine_code import MachineCode

            dispatcher._cache = MachineCode(function, folder)
    return dispatcher


@contextmanager
def _no_collection() -> Iterator[None]:
    """Without looking for garbage, of which there is none among what is imported."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


@cache
def _numba() -> Any:
    """Numba, which from then on takes `Compiled` loops that others call for its own."""
    with _no_collection():
        import numba
        from numba.core import event, types
        from numba.extending import typeof_impl

    class Told(event.Listener):
        def on_start(self, _: object) -> None:
            _tell(True)

        def on_end(self, _: object) -> None:
            _tell(False)

    # Held while a loop is loaded or compiled, with all that it calls.
    event.register("numba:compiler_lock", Told())

    @typeof_impl.register(Compiled)
    def type_of(loop: Compiled[..., Any], _context: object) -> Any:
        return types.Dispatcher(loop.dispatcher)

    return numba
