"""Baselines for bodies that drive, in the backend ``free``."""
