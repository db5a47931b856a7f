"""A training run in its folder: checkpoints, the released agents, exports."""
