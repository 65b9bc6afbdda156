"""The pose of a far pad, by its whole pattern at once. `image_alignment` is where to begin."""
