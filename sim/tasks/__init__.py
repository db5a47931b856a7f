"""Tasks of agents, and the places in a house where episodes start and targets lie."""
