"""Briefs to measure generators by: a frozen set of them, and what is right in an answer."""
