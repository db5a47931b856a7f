"""What all algorithms share: configs, replay, ranks, environments."""
