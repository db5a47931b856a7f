"""Map of what the rays show: the occupancy map, and the target that was seen."""
