"""Explanations of parts of a house: derivations, and alternatives."""
