"""The forms of the REST interface."""
