"""Studies of agents: their scores, their speed of learning, and where their steps go."""
