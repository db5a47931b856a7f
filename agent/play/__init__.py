"""Games: people play the simulator's episodes, alone or against an agent."""
