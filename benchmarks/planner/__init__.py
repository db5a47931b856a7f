"""Studies of the planner: ``explorers`` compares configurations, ``odds`` measures one of its tables."""
