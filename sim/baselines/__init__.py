"""What agents are measured beside: shortest paths, and search in a house that is known."""
