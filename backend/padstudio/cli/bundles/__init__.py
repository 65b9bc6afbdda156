"""Commands that make a bundle of a frame, and read one again."""
