"""A camera over a printed pad, with the truth of every frame; and what a pad's sizes can do.

May import `padstudio.render`, `padstudio.pad`, `padstudio.geometry` and `padstudio.errors`; Numba
is loaded at the first picture, PyAV at the first video.
"""
