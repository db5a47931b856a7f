"""Generation of houses: both stages, and the feedback from stage 2 to stage 1."""
