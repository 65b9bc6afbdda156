"""Flights that a server analyses, ordered and fetched by one command."""
