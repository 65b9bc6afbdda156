"""Reading of stills, videos, archives and telemetry, from disk or from remote storage.

Knows neither the database nor the detector.
"""
