"""Pages that show the houses of a grammar: watch, with a server, and playground, without one."""
