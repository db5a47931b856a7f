"""Study of the cost of a simulator step, compared with the same step in C and with other simulators."""
