"""From a first pose to the best one: by borders of cells, or from afar by the whole pattern."""
