"""Steps of planners whose bodies move on a lattice."""
