"""Sets of many houses: files of rows, generated independently, reproducible, and readable by other tools."""
