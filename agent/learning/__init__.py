"""What all algorithms share: learners, configs, replay, ranks, environments."""
