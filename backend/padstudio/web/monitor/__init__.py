"""A live session over HTTP: what it sees, as it sees it, and its last frames."""
