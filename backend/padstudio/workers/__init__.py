"""The pool of worker processes, and everything that runs in one of them for a request."""
