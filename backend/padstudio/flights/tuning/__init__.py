"""How are one frame's parameters tuned: looks at its stages, its cells, sweeps over frames."""
