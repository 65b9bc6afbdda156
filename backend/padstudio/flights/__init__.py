"""Flights: jobs, the chunks they are parted into, who works on them, and what came out.

`service` is the one object that the server holds.
"""
