"""Similarity of two sets of plans, generated or real, and weights of a grammar that increase it."""
