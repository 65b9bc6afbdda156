"""Random numbers for compiled searches: the same on every platform."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import pure_jit

# SplitMix64's increment (2^64 over the golden ratio), multipliers and shifts.
_STEP = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_S27, _S30, _S31, _S33 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(33)


@pure_jit
def draw(state: NDArray[np.uint64], below: int) -> int:
    """A number 0 … below − 1; the stream depends on ``state`` (1,) alone, on every platform.

    SplitMix64: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014,
    doi:10.1145/2660193.2660195.
    """
    state[0] += _STEP
    z = state[0]
    z = (z ^ (z >> _S30)) * _MIX_1
    z = (z ^ (z >> _S27)) * _MIX_2
    z = z ^ (z >> _S31)
    return int(np.int64(z >> _S33)) % below


def random_state(seed: int, stream: int = 0) -> NDArray[np.uint64]:
    """The (1,) uint64 state for a seed of any size; other streams are independent of it."""
    entropy = np.random.SeedSequence([abs(seed), int(seed < 0), stream])
    return entropy.generate_state(1, np.uint64).astype(np.uint64)
