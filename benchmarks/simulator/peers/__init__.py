"""Other simulators, each by a script with a Python environment of its own that uv makes."""
