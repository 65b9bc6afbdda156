"""Error budget: how much of a pose's error comes from what, by simulation of each source alone."""
