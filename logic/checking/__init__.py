"""Checks that a house keeps its promises: plain geometry, independent of the rules."""
