"""What stages have in common: parameters, the trace, and the detection that callers get."""
