"""Hostile inputs, made to do harm: each is answered, and has no effect."""
