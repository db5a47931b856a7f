"""The original paper's agent."""
