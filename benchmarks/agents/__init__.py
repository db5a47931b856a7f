"""How well agents do, how fast they learn, and where their steps go."""
