"""What a user asks for: counts of rooms, fixed rooms, or a plan of their own."""
