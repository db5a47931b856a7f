"""The algorithms, a folder each, and the presets that run by name."""
