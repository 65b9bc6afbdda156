"""Pictures of a flight's frames: stages painted again, and previews."""
