"""A training run in its folder: checkpoints, what comes with the project, exports."""
