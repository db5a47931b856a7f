"""Baselines: policies that learn nothing, searchers that know the house, and coverage of a house."""
