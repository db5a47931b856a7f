"""Q-learning over viewpoints: which of the views that a planner offers to go to next. It starts from the
planner's own choice; ``docs/planner.md`` tells what it learns.
"""
