"""Oracle: the fewest actions to a known target."""
