"""The work itself: how a flight is parted, and what becomes of one part of it."""
