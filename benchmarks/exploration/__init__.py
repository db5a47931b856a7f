"""``vitruvius bench exploration``: agents that explore maps of buildings, and the area that they saw."""
