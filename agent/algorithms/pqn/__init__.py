"""Parallel Q-learning: a rollout, its returns, and a network with a fixed or learned memory."""
