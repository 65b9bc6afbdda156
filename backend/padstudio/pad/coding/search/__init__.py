"""How fields are found: sequences, searches by rows, growth; all deterministic by seed."""
