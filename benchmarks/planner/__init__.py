"""Studies of the planner's numbers, predictions and choices."""
