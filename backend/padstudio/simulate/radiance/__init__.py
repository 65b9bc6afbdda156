"""Light that reaches the sensor: ground, inks, surface, lens, integrated over pixels."""
