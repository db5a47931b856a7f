"""What an agent is measured beside: shortest paths, and search that knows where it has looked."""
