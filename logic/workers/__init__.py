"""Solvers in processes of their own, confined, and what is asked of them: generate, lint, explain, check."""
