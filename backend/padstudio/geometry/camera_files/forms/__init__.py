"""One module for each form of camera file."""
