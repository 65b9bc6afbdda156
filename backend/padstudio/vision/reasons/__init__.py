"""Why a frame failed, or is to be doubted: a second look that runs where it is asked for."""
