"""Steps of planners whose bodies drive: the map, views and paths from any pose."""
