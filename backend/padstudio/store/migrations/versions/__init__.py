"""Revisions of the database; each keeps its own copy of what it needs."""
