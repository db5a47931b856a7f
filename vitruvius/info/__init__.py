"""Description of files, folders and names: houses, a grammar, an agent, a run."""
