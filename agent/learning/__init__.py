"""Common parts of all algorithms: learners, configs, replay, ranks, environments."""
