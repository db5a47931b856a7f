"""Solvers in separate, confined processes, and the questions that they answer."""
