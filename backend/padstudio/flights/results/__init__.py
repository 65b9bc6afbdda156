"""What came of a flight, read from the database: frames, summaries, charts."""
