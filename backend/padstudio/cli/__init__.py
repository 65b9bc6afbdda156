"""The command line: one module a command, assembled in `program`. May import everything."""
