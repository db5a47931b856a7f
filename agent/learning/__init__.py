"""What every algorithm learns by: configs, rollouts, replay, ranks, environments."""
