"""Rewards, resets, targets and random numbers of all environments: the kernel of a step."""
