"""What the planner's numbers, its predictions and its choices are worth."""
