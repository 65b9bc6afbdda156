"""What a live session recorded, as a flight whose poses are there already."""
