"""Fields in which every window occurs once: `generate` makes them, `verify` proves them."""
