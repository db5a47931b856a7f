"""Next best view: the places where targets may lie, those within reach, and what a view would show."""
