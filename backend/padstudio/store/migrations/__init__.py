"""The database's revisions, in order; run on every start."""
