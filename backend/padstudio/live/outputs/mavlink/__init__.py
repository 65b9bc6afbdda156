"""Poses to an autopilot, as MAVLink messages over UDP, TCP or a serial port."""
