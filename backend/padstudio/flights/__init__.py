"""Stored pads, cameras and flights, and the work on them."""
