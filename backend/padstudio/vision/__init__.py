"""The detector: one file a stage, `pipeline` alone knows their order.

May import `padstudio.pad`, `padstudio.geometry` and `padstudio.errors`.
"""
