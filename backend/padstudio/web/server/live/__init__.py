"""Live sessions of a server: each in a process of its own."""
