"""What a user asks for: counts of rooms, rooms that are fixed, a plan of their own."""
