"""A camera simulator with truth."""
