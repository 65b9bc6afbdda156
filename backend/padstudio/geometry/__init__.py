"""Cameras, poses and plane homographies; knows nothing of pads.

May import only `padstudio.errors`.
"""
