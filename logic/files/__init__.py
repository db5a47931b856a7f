"""House files and ROS maps: reading, writing as a whole, and protection against overwriting."""
