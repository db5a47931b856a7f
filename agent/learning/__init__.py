"""What every algorithm learns by: configs, replay, ranks, environments."""
