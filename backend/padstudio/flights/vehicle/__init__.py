"""A flight's poses beside its vehicle's log: one clock, one mounting, what they differ in."""
