"""Keeps a stream as it came, and the poses beside it."""
