"""Camera files of many programs: read whole or refused by name, and written.

`docs/camera-files.md` lists every form and key.
"""
