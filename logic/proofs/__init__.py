"""Proofs that there is no house: a minimal unsatisfiable core of the user's statements."""
