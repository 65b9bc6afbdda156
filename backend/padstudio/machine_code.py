"""Machine code of compiled loops on disk, kept and loaded for Numba's dispatchers.

Numba's own cache prepares, before it loads the first function, all that compiling one takes (its
registries of types and functions), and parses for each function the code that only other functions
need when they are compiled. Loading is most of a short program's time, so here both wait until
something is compiled.
"""

from __future__ import annotations

import pickle
import sys
from contextlib import suppress
from functools import cache
from hashlib import blake2b
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from llvmlite import __version__ as llvmlite_version
from llvmlite.binding import add_symbol, parse_bitcode
from numba import __version__
from numba.core.compiler import compile_result
from numba.core.serialize import dumps

_DIGEST_BYTES = 16


class MachineCode:
    """Compiled code of one function, a file for each signature.

    Takes the place of `numba.core.caching.FunctionCache`. It asks nothing of the function's source:
    the folder is to be named by it.

    Parameters
    ----------
    function : callable
    folder : Path
    """

    def __init__(self, function: Any, folder: Path) -> None:
        home, _, module = str(function.__module__).rpartition(".")
        self.cache_path = folder / home
        self._name = f"{module}.{function.__qualname__}"

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The code for a signature, ready to be called; None where none is kept."""
        # Whatever is wrong with a file, the function can be compiled.
        with suppress(Exception):
            data = self._path(signature, context).read_bytes()
            digest, code = data[:_DIGEST_BYTES], data[_DIGEST_BYTES:]
            if digest == self._digest(code):
                _start_runtime()
                return _rebuilt(pickle.loads(code), context)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep what was compiled for a signature, where it can be written."""
        if result.library.has_dynamic_globals:
            # Addresses of this process are in its code.
            return
        code = dumps(result._reduce())
        with suppress(OSError):
            self.cache_path.mkdir(parents=True, exist_ok=True)
            # Other machines may write to the folder, too, whose processes have the same numbers.
            with TemporaryDirectory(dir=self.cache_path) as own:
                fresh = Path(own, "code")
                fresh.write_bytes(self._digest(code) + code)
                fresh.replace(self._path(signature, result.target_context))

    def _digest(self, code: bytes) -> bytes:
        """Of the code and of whose it is."""
        return blake2b(self._name.encode() + b"\0" + code, digest_size=_DIGEST_BYTES).digest()

    def _path(self, signature: Any, context: Any) -> Path:
        """The file for a signature, on this processor, for this Python and Numba."""
        versions = sys.version_info[:2], sys.abiflags, __version__, llvmlite_version
        key = repr((signature, context.codegen().magic_tuple(), versions)).encode()
        return self.cache_path / f"{self._name}-{blake2b(key, digest_size=8).hexdigest()}"


@cache
def _start_runtime() -> None:
    """Tell LLVM where the functions of Numba's run time are."""
    helpers = import_module("numba.core.runtime._nrt_python").c_helpers
    for name, address in helpers.items():
        add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


def _rebuilt(kept: tuple[Any, ...], context: Any) -> Any:
    """As `numba.core.compiler.CompileResult._rebuild`; code for others' use is not parsed yet."""
    code, fndesc, env, signature, objectmode, lifted, annotation, reload_init, envs = kept
    name, _, (machine_code, bitcode) = code
    for start in reload_init:
        start()
    codegen = context.codegen()
    library = codegen.create_library(name)
    library.enable_object_caching()
    library._set_compiled_object(machine_code)
    library._finalize_final_module()
    library._get_module_for_linking = cache(lambda: parse_bitcode(bitcode))
    codegen._engine._defined_symbols |= {fndesc.llvm_func_name, fndesc.llvm_cpython_wrapper_name}
    entry_point = context.get_executable(library, fndesc, env)
    for referenced in envs:
        codegen.set_env(referenced.env_name, referenced)
    return compile_result(
        typing_context=context.typing_context,
        target_context=context,
        entry_point=entry_point,
        type_annotation=annotation,
        signature=signature,
        objectmode=objectmode,
        lifted=lifted,
        fndesc=fndesc,
        library=library,
        environment=env,
        reload_init=reload_init,
        referenced_envs=envs,
    )
