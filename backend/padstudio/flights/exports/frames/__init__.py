"""The frames behind a flight's records: their clock, names, sizes, cameras and pictures."""
