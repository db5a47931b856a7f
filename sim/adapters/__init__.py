"""Environments for other libraries: MiniGrid, Stable-Baselines3."""
