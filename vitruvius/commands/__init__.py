"""Commands: one dataclass each, whose fields are its options."""
