"""Baselines for agents: shortest paths, and search in a known house."""
