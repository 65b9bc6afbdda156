"""Pictures of what the stages gave. Stages never draw."""
