"""What lasts: the database, uploads and traces. Knows no pictures, no jobs and no web."""
