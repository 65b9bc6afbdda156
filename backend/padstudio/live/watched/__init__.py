"""A live session in a process of its own, for who watches it over a server."""
