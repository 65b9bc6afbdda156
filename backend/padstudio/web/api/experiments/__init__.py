"""Experiments: orders, kinds, and what came of them."""
