"""Live: from a camera's stream to poses that an autopilot takes.

Always the newest frame: what cannot be read in time is dropped and counted, never queued.
"""
