"""What others wrote of a flight: subtitles of the camera's, logs of the vehicle's.

`reading.read` takes any of them; `columns` is what all of them become.
"""
