"""The door to compiled loops: what is imported when, and whether kept machine code still holds."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import padstudio

PACKAGE = Path(padstudio.__file__).parent
CALLEE = """
from padstudio.compiled import jit

FACTOR = {factor}

@jit
def grown(x):
    return FACTOR * x
"""
CALLER = """
from padstudio.callee import grown
from padstudio.compiled import jit

@jit
def grown_and_one(x):
    return grown(x) + 1
"""


def run(code: str, path: Path, **environment: str) -> str:
    # Without NUMBA_CACHE_DIR, machine code lies beside the copy of the package.
    kept = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    # Bytecode would not notice sources that change twice within a second.
    kept["PYTHONDONTWRITEBYTECODE"] = "1"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**kept, "PYTHONPATH": str(path), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def package(path: Path, factor: int) -> Path:
    """A package with the real door and two loops, one of which calls the other."""
    home = path / "padstudio"
    home.mkdir(exist_ok=True)
    for name in ("__init__.py", "compiled.py", "machine_code.py"):
        shutil.copy(PACKAGE / name, home)
    (home / "callee.py").write_text(CALLEE.format(factor=factor))
    (home / "caller.py").write_text(CALLER)
    return path


def folders(path: Path) -> list[Path]:
    return sorted((path / "padstudio" / "__pycache__").glob("compiled-*"))


CALL = "from padstudio.caller import grown_and_one; print(grown_and_one(5))"


def test_a_changed_callee_in_another_file_changes_the_result(tmp_path: Path) -> None:
    assert run(CALL, package(tmp_path, 2)) == "11"
    assert run(CALL, package(tmp_path, 3)) == "16"
    assert run(CALL, package(tmp_path, 2)) == "11"
    assert len(folders(tmp_path)) == 2


def test_a_changed_constant_of_a_module_without_loops_changes_the_result(tmp_path: Path) -> None:
    home = package(tmp_path, 2) / "padstudio"
    taken = "from padstudio.plain import FACTOR"
    (home / "callee.py").write_text(CALLEE.format(factor=2).replace("FACTOR = 2", taken))
    for factor, result in ((2, "11"), (3, "16")):
        (home / "plain.py").write_text(f"FACTOR = {factor}\n")
        assert run(CALL, tmp_path) == result


def test_machine_code_is_kept_between_processes(tmp_path: Path) -> None:
    hits = f"{CALL}; print(sum(grown_and_one.dispatcher.stats.cache_hits.values()))"
    assert run(hits, package(tmp_path, 2)).split() == ["11", "0"]
    assert run(hits, tmp_path).split() == ["11", "1"]


def test_machine_code_of_older_sources_is_forgotten(tmp_path: Path) -> None:
    run(CALL, package(tmp_path, 2))
    run(CALL, package(tmp_path, 3))
    forget = "from padstudio import compiled; compiled.forget_older()"
    newest = run(f"{forget}; print(compiled.cache_folder())", tmp_path)
    assert folders(tmp_path) == [Path(newest)]


def test_the_environment_says_where_machine_code_is_kept(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    assert run(CALL, package(tmp_path, 2), NUMBA_CACHE_DIR=str(kept)) == "11"
    assert list(kept.glob("compiled-*/*/caller.grown_and_one*"))
    assert folders(tmp_path) == []


def test_where_nothing_can_be_written_loops_are_compiled_all_the_same(tmp_path: Path) -> None:
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where a folder should be")
    assert run(CALL, package(tmp_path, 2), NUMBA_CACHE_DIR=str(blocked)) == "11"


def test_machine_code_that_may_only_be_read_is_used(tmp_path: Path) -> None:
    home = package(tmp_path, 2)
    run(CALL, home)
    kept = folders(home)[0]
    written = {path: path.stat().st_mtime_ns for path in kept.rglob("*")}
    # As root may write anywhere, writing is what fails here.
    broken = "import pathlib; pathlib.Path.write_bytes = lambda *_: (_ for _ in ()).throw(OSError)"
    hits = f"{broken}; {CALL}; print(sum(grown_and_one.dispatcher.stats.cache_hits.values()))"
    assert run(hits, home).split() == ["11", "1"]
    assert {path: path.stat().st_mtime_ns for path in kept.rglob("*")} == written


def test_code_under_another_loops_name_is_not_called(tmp_path: Path) -> None:
    run(CALL, package(tmp_path, 2))
    (kept,) = folders(tmp_path)
    files = [path for path in kept.rglob("*") if path.is_file()]
    (callee,) = [path for path in files if path.name.startswith("callee.grown-")]
    (caller,) = [path for path in files if path.name.startswith("caller.grown_and_one-")]
    caller.write_bytes(callee.read_bytes())
    assert run(CALL, tmp_path) == "11"


def test_code_of_which_a_bit_has_changed_is_not_called(tmp_path: Path) -> None:
    run(CALL, package(tmp_path, 2))
    for path in [path for path in folders(tmp_path)[0].rglob("*") if path.is_file()]:
        code = bytearray(path.read_bytes())
        code[len(code) // 2] ^= 1
        path.write_bytes(code)
    hits = f"{CALL}; print(sum(grown_and_one.dispatcher.stats.cache_hits.values()))"
    assert run(hits, tmp_path).split() == ["11", "0"]


def test_numba_waits_for_the_first_call() -> None:
    code = (
        "import sys; import padstudio.vision.detector, padstudio.pad.coding.generate;"
        "print('numba' in sys.modules)"
    )
    assert run(code, PACKAGE.parent) == "False"


def test_kept_code_of_a_callee_serves_a_caller_that_is_compiled_anew(tmp_path: Path) -> None:
    kept = package(tmp_path, 2) / "padstudio" / "__pycache__"
    callee_first = f"from padstudio.callee import grown; print(grown(5)); {CALL}"
    assert run(callee_first, tmp_path).split() == ["10", "11"]
    for code in kept.rglob("caller.*"):
        code.unlink()
    assert run(callee_first, tmp_path).split() == ["10", "11"]
    hits = "print(sum(grown.dispatcher.stats.cache_hits.values()))"
    assert run(f"{callee_first}; {hits}", tmp_path).split() == ["10", "11", "1"]


def test_kept_code_that_is_damaged_is_compiled_anew(tmp_path: Path) -> None:
    assert run(CALL, package(tmp_path, 2)) == "11"
    for code in (tmp_path / "padstudio" / "__pycache__").rglob("caller.*"):
        if code.suffix != ".pyc":
            code.write_bytes(code.read_bytes()[:100])
    assert run(CALL, tmp_path) == "11"


def test_kept_code_is_loaded_without_what_compiling_takes(tmp_path: Path) -> None:
    code = f"{CALL}; import sys; print('numba.np.arraymath' in sys.modules)"
    assert run(code, package(tmp_path, 2)).split() == ["11", "True"]
    assert run(code, tmp_path).split() == ["11", "False"]
