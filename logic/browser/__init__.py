"""Pages that show what a grammar makes: watch, with a server; playground, without one."""
