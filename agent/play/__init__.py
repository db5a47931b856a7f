"""People play the simulator's episodes: ``vitruvius play``, and its results beside agents."""
