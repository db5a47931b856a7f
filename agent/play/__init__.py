"""People play the simulator's episodes, alone or beside an agent."""
