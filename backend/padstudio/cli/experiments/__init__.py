"""Commands that make experiments on the simulator."""
