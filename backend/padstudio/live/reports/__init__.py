"""What the parts of a live session hand each other."""
