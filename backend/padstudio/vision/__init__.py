"""The detector: `detector` is the one object that callers use, `dense.method` its recipe.

A folder is one question of that recipe; they import each other in the order of their work.
"""
