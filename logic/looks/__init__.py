"""Looks of types of rooms and pieces on plans, from JSON files."""
