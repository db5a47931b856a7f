"""The commands: a dataclass each, whose fields are its options."""
