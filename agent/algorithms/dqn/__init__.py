"""Deep Q-learning from a replay buffer."""
