"""``vitruvius bench exploration``: agents that explore maps of buildings, and what they have seen of them."""
