"""Sets of many houses: files of reproducible rows that other tools can read."""
