"""Studies of the generator: difficulty of houses, uniformity of sampling, and correctness of answers."""
