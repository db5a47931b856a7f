"""The next best view: where targets may lie, what can be reached, what a view would show."""
