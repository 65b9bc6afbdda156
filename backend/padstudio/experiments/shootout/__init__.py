"""A shoot-out: the user's pad against other boards of its size, on the same simulated flight."""
