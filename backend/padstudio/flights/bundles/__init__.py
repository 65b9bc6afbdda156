"""Failure bundles: one frame with all that its result rests on, in one zip that opens anywhere."""
