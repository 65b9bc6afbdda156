"""The boards of a shoot-out: how each is printed at the size of a pad, and read."""
