"""Warming compiles every inner loop that a detection may need."""

from padstudio.vision import kernels, kernels_search, warm


def test_warming_reads_its_frames_and_compiles_every_kernel():
    assert warm.warm_up()
    everything = vars(kernels) | vars(kernels_search)
    compiled = {name: f for name, f in everything.items() if hasattr(f, "signatures")}
    assert len(compiled) >= 5
    assert [name for name, function in compiled.items() if not function.signatures] == []
