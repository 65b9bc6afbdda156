"""From a frame to planes, regions and the pictures that stages look at."""
