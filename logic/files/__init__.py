"""House files and maps of ROS: read, written whole, and not overwritten by mistake."""
