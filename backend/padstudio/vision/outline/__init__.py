"""The whole sign by its four sides, where cells are too small to read."""
