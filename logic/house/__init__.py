"""Houses and their parts, house files, and the looks and names of types."""
