"""Cells: which are visible, what level each has, and whether that can be chance."""
