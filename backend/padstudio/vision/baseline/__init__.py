"""The method `paper`: the source paper's steps, to the letter. `method` is its recipe."""
