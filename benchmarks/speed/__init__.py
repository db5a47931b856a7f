"""Study of speed: steps per second of the simulator, planners, agents that play, and training."""
