"""The vehicle under the camera, in the words of autopilots: mounting, frames, LANDING_TARGET."""
