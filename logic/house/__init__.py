"""Model of a house: rooms, walls, doors, pieces, their records and names, and promises about them."""
