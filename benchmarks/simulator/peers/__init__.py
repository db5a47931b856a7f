"""Other simulators, each in a script whose Python environment uv creates."""
