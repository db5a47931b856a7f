"""Studies of how well tests, checks and proofs notice what is wrong."""
