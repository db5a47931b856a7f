"""Generation of houses: both stages for a request, and the feedback from stage 2 to stage 1."""
