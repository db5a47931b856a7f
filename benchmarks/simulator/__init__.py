"""What a step of the simulator costs, beside the same step in C and other simulators."""
