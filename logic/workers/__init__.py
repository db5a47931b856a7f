"""Solvers in processes of their own, with few rights, and the questions that they answer."""
