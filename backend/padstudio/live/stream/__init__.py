"""Where frames come from: streams and devices, their newest frame at any time."""
