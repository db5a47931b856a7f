"""Algorithms, one folder each, and the presets that run by name."""
