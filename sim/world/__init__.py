"""State of all environments, and the kernel that steps it: rewards, resets, targets."""
