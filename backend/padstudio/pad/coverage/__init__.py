"""From where a pad can be read, in closed form: spans of heights, gaps, advice."""
