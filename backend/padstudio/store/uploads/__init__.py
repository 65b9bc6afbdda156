"""Uploads: their rows, their files, their limits."""
