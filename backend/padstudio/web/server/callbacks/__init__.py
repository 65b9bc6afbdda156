"""Who is called when a flight has ended, and how."""
