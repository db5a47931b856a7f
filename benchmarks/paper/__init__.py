"""Study of the paper that this project grew from: its claims, and the results here."""
