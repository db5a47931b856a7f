"""Numbers, state and arrays of a planner, which all of its parts share."""
