"""Stage 2, SWI-Prolog: every length of a house, by linear constraints."""
