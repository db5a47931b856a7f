"""A house and its parts, its files, and how it looks and is named."""
