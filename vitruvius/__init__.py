"""The command line: commands and their options, help, answers for programs. It knows all and is known by none."""
