"""From a first pose to the refined one: borders, least squares, alignment, covariance."""
