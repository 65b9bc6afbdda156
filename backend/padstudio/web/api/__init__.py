"""The REST interface, a router a module."""
