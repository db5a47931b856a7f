"""What is asked of agents, and where in a house starts and targets may lie."""
