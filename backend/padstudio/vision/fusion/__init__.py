"""How poses of single frames go together over time: a filter without look-ahead, a smoother."""
