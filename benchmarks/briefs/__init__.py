"""Benchmark of generators: a frozen set of briefs, and the checks of an answer."""
