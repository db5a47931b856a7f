"""An episode as a film, or as a trace that a report plays."""
