"""Baselines for agents: policies that learn nothing, searchers that know the house, coverage, and drivers."""
