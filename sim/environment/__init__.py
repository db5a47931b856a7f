"""Gymnasium's interface over the world: many environments, or a single one."""
