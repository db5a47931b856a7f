"""Other simulators, each by a script whose Python environment uv makes."""
