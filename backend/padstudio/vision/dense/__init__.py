"""The method `dense`: everything in the picture counts. `method` is its recipe."""
