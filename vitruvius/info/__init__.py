"""What a file, a folder or a name is: houses, a grammar, an agent, a run, and what else there is of ours."""
