"""Recordings of an episode: a film, or a trace that a report plays."""
