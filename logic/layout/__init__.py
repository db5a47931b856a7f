"""Stage 1, clingo: every discrete choice of a house, as atoms."""
