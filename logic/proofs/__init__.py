"""Why there is no house: a minimal set of statements in conflict."""
