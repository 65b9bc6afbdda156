"""Painters: each turns a layout into one file form and decides nothing."""
