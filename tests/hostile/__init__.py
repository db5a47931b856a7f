"""Inputs that others might have made to do harm: each is answered, and has no effect."""
