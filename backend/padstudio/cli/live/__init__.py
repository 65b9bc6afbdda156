"""``padstudio live``: a camera's stream to an autopilot and to other programs."""
