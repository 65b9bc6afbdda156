"""Flights: orders, results, figures, pictures, exports."""
