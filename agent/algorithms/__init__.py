"""The algorithms, and their configs that run by name."""
