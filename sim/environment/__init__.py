"""Gymnasium's interface: many environments at once, or a single one."""
