"""Training runs in their folders: checkpoints, the released agents, exports."""
