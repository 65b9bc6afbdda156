"""The process of a reader: calls what it is told to, until its input ends.

Run as a program by `padstudio.experiments.shootout.reader_process`. What libraries print goes to
stderr, so that nothing comes between the answers.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys

#: Environment that keeps libraries to one thread; they read it when they are loaded.
ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "RAYON_NUM_THREADS",
        "NUMBA_NUM_THREADS",
    ),
    "1",
)


def serve() -> None:
    """Read (seconds, function, arguments), write ("value" or "error", what came of it)."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    if hasattr(signal, "SIGINT"):
        # Ctrl-C reaches the whole group; who asked ends this process.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            limit_s, function, args = pickle.load(sys.stdin.buffer)
        except EOFError:
            # Without the destructors of the libraries, one of which frees memory twice.
            os._exit(0)
        if hasattr(signal, "alarm"):
            # Ends the process even where a library hangs and nobody is left to end it.
            signal.alarm(int(limit_s) + 5)
        try:
            answer = ("value", function(*args))
        except Exception as error:
            answer = ("error", f"{type(error).__name__}: {error}")
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    serve()
