"""What the studies of ``vitruvius bench`` found: series, fitted laws, pages of results."""
