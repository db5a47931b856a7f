"""The command line: commands, options, help, answers for programs. It knows all and is known by none."""
