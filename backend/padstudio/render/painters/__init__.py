"""Painters of a layout, one file form each, and the inks and shapes that they share."""
