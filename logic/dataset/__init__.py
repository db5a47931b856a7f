"""Sets of many houses: files of rows that are made apart from each other, again, and read by other tools."""
