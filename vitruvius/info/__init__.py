"""What a file, a folder or a name is: houses, a grammar, an agent, a run."""
