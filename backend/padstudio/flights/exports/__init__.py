"""Poses in other programs' forms, one file a form; `forms` knows them all.

Each is a pure function from records of a poses file to bytes, in pieces. May import what
`padstudio.flights` may; nothing here reads a database or a request.
"""
