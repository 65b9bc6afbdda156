"""Recordings of robots as a source of frames: ROS 1 bags, ROS 2 bags and MCAP files."""
