"""Figures of experiments, as plain SVG."""
