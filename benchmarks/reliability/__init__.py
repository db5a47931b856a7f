"""Studies of what must never happen: a wrong answer, a mistake that no test notices, a torn file."""
