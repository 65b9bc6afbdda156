"""The experiments of the paper on double-layer unique coding, made again on the simulator."""
