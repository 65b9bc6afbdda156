"""Compiles all inner loops ahead: ``python -m padstudio.warm``, as part of an installation.

The first pad and the first detection would otherwise take some ten seconds longer each. The machine
code is kept on disk, so that this warms all later processes.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from padstudio.compiled import forget_older
from padstudio.pad.coding import warm as pad_warm
from padstudio.vision import warm as vision_warm


def warm_up() -> None:
    """Generate small fields by every method, and read a small pad, side by side."""
    forget_older()
    with ProcessPoolExecutor(max_workers=2, mp_context=get_context("spawn")) as pool:
        for done in (pool.submit(pad_warm.warm_up), pool.submit(vision_warm.warm_up)):
            done.result()


if __name__ == "__main__":
    warm_up()
