"""Paper that is not flat: its heights, found together with the pose."""
