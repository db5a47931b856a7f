"""Agent of the original paper."""
