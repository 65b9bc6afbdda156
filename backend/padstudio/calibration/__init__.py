"""A camera's intrinsics and lens from pictures of a pad."""
