"""Requests: counts of rooms, fixed rooms, briefs, or a plan of the user."""
