"""Where poses go: autopilots, JSON lines, event streams."""
