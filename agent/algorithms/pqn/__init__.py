"""Parallel Q-learning: a rollout, its returns, a network with a memory that is fixed or learnt."""
