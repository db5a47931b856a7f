"""Evaluation of agents: episodes in houses that are new to them, compared with baselines."""
